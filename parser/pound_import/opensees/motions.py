"""Ground motions: UniformExcitation with a Path, of a file or in the script, or a Trig."""

from __future__ import annotations

from collections.abc import Callable

from pound_import.draft import Draft, number, quoted
from pound_import.opensees.commands import Command, options
from pound_import.opensees.model import ScriptModel
from pound_import.opensees.replay import Replayed
from pound_import.opensees.series import TimeSeries, series

_AXES = {1: "X", 2: "Y"}


class Motions:
    """Writer of ground motions.

    Parameters
    ----------
    model : ScriptModel
    draft : Draft
    replayed : Replayed
        Has the folder of the model, and the texts of the files that it wrote.
    shown : function
        Name of a file beside the model as the new deck names it.
    """

    def __init__(
        self, model: ScriptModel, draft: Draft, replayed: Replayed, shown: Callable[[str], str]
    ) -> None:
        self._model, self._draft, self._shown = model, draft, shown
        self._folder, self.written = replayed.folder, replayed.written

    def write(self, command: Command) -> None:
        """Write the motion of a pattern UniformExcitation.

        Raises
        ------
        Mistake
            Its direction, its series or an option has no counterpart.
        """
        choice = options(command, 3)
        choice.only(("-accel", "-fact", "-factor"))
        direction = command.whole(3, "the direction")
        if direction not in _AXES:
            raise command.mistake("a rotation of the ground about its nodes has no counterpart")
        words = choice.flags.get("-accel", ())
        acting = series(self._model, " ".join(words), command)
        scale = choice.real("-fact", choice.real("-factor", 1.0))
        axis = f"DIRECTION={_AXES[direction]}"
        self._draft.add("EQUAKE", f"{self.samples(acting, scale)} {axis}", command.span)

    def samples(self, acting: TimeSeries, scale: float) -> str:
        """Card of a motion; raises as `write`."""
        if acting.kind == "Trig":
            amplitude = number(scale * acting.factor)
            return f"SINE AMPLITUDE={amplitude} {wave(acting)}"
        if acting.kind != "Path":
            raise acting.command.mistake(f"a motion with the series {acting.kind[:40]}")
        if acting.path() and acting.path() not in self.written:
            file, layout = self.record(acting)
            return f"RECORD {file} UNIT=DECK SCALE={number(scale * acting.factor)} {layout}"
        return table(self.points(acting), scale)

    def record(self, acting: TimeSeries) -> tuple[str, str]:
        """File of a Path and its layout; raises as `write`."""
        if acting.choice.flags.get("-fileTime"):
            hint = "write times and values into one file with two columns"
            raise acting.command.mistake("a Path with -fileTime", hint)
        if not (self._folder / acting.path()).is_file():
            what = f"the record {acting.path()}, which is not in the folder of the model"
            self._draft.lose(acting.command.span, what, "put it there, or its new path into the new deck")
        return quoted(self._shown(acting.path())), f"FORMAT=COLUMNS DT={number(_step(acting))} COLUMN=0"

    def points(self, acting: TimeSeries) -> list[tuple[float, float]]:
        """Times and values of a Path without a file, or of one that the model wrote; raises as `write`."""
        if not acting.path():
            return acting.points()
        step, text = _step(acting), self.written[acting.path()]
        words = Command(tuple(text.split()), acting.command.span)
        return [(step * k, acting.factor * words.real(k, "a sample")) for k in range(len(words.words))]


def _step(acting: TimeSeries) -> float:
    """Step of a Path; raises a Mistake where there is none."""
    step = acting.choice.real("-dt", 0.0)
    if step <= 0.0:
        raise acting.command.mistake("a Path without a step -dt above 0", code="L620")
    return step


def wave(acting: TimeSeries) -> str:
    """Items of a Trig series but for its amplitude."""
    given = acting.sine()
    return (
        f"PERIOD={number(given['period'])} PHASE={number(given['phase'])} START={number(given['start'])} "
        f"DURATION={number(given['end'] - given['start'])}"
    )


def table(points: list[tuple[float, float]], scale: float) -> str:
    """Card of values with their times."""
    return "TABLE POINTS=" + ",".join(f"{number(t)},{number(scale * value)}" for t, value in points)
