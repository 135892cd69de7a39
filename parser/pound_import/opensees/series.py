"""Time series: factors of loads and accelerations over time.

A series is a command of its own (``timeSeries``), or words within a pattern, the older form.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from pound_import.opensees.commands import Command, Flags, options
from pound_import.opensees.model import ScriptModel

_FLAGS: Final = (
    "-dt",
    "-filePath",
    "-fileTime",
    "-values",
    "-time",
    "-factor",
    "-prependZero",
    "-startTime",
)


@dataclass(frozen=True, slots=True)
class TimeSeries:
    """A time series.

    Attributes
    ----------
    command : Command
        That gave it.
    kind : str
        Linear, Constant, Path or Trig.
    choice : Flags
        Its words.
    """

    command: Command
    kind: str
    choice: Flags

    @property
    def factor(self) -> float:
        """Factor on its values."""
        return self.choice.real("-factor", 1.0)

    def value(self, time: float) -> float:
        """Value of a Linear or Constant series.

        Raises
        ------
        Mistake
            It is another one, whose values are in a file.
        """
        if self.kind == "Linear":
            return self.factor * time
        if self.kind == "Constant":
            return self.factor
        raise self.command.mistake(f"a static load with the series {self.kind[:40]}", "use a Linear series")

    def path(self) -> str:
        """Name of the file of the values, empty where they stand in the command."""
        return (*self.choice.flags.get("-filePath", ()), "")[0]

    def points(self) -> list[tuple[float, float]]:
        """Times and values that stand in the command.

        Raises
        ------
        Mistake
            Times or values are missing, or their numbers differ.
        """
        values, times = self.choice.reals("-values"), self.choice.reals("-time")
        if not times:
            times = evenly(self.choice.real("-dt", 0.0), len(values))
        if len(values) < 2 or len(values) != len(times):
            what = f"a series of {len(values)} values and {len(times)} times"
            raise self.command.mistake(what, code="L620")
        return [(t, self.factor * value) for t, value in zip(times, values)]

    def sine(self) -> Mapping[str, float]:
        """Numbers of a Trig series: start, end, period and phase."""
        words = Command(("Trig", *self.choice.plain), self.command.span)
        start, end, period = words.reals(1, "tStart tEnd period")
        if period <= 0.0 or end <= start:
            raise self.command.mistake("a Trig series of no duration or period", code="L620")
        phase = self.choice.real("-shift", self.choice.real("-phaseShift", 0.0))
        return {"start": start, "end": end, "period": period, "phase": phase}


def evenly(step: float, count: int) -> list[float]:
    """Times of a constant step, as many as asked for."""
    return [step * k for k in range(count)] if step > 0.0 else []


def series(model: ScriptModel, word: str, command: Command) -> TimeSeries:
    """Series that a pattern names by a tag, or states in words.

    Raises
    ------
    Mistake
        There is none, or it is of a kind that has no counterpart.
    """
    words: Sequence[str] = word.replace("{", " ").replace("}", " ").split()
    if len(words) == 1 and words[0].lstrip("+-").isdigit():
        command = model.item("the series", model.series, int(words[0]), command)
        words = (command.words[1], *command.words[3:])
    if not words:
        raise command.mistake("the series is missing", code="L620")
    kind = "Path" if words[0] == "Series" else words[0]
    if kind in ("Sine", "Harmonic"):
        kind = "Trig"
    if kind not in ("Linear", "Constant", "Path", "Trig"):
        raise command.mistake(f"the series {kind[:40]} has no counterpart", "use Linear, Path or Trig")
    choice = options(Command(("timeSeries", *words), command.span), 2)
    if kind == "Path":
        choice.only(_FLAGS)
        if "-prependZero" in choice.flags or choice.real("-startTime", 0.0) != 0.0:
            raise command.mistake(
                "a Path with -prependZero or -startTime", "write the times into the file: -fileTime"
            )
    return TimeSeries(command, kind, choice)
