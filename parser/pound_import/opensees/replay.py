"""Replay of a model in a process of its own, and the commands that it writes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from threading import Timer
from typing import Any, Final

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Span
from pound_import.opensees.commands import Command

SECONDS: Final = 60.0  #: that a replay may take
#: for libraries that a model in Python imports: one thread, no windows
_QUIET: Final = {"OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}


@dataclass(frozen=True, slots=True)
class NaturalModes:
    """Natural modes of a model.

    Attributes
    ----------
    values : sequence of float
        Squares of circular frequencies [1/T^2].
    shapes : mapping of int to sequence of sequence of float
        For each node and mode its displacements along x and y and its rotation.
    """

    values: Sequence[float] = ()
    shapes: Mapping[int, Sequence[Sequence[float]]] = field(default_factory=dict)


#: finds modes, so many, of the model that the commands so far define
Eigen = Callable[[Sequence[Command], int], NaturalModes]


@dataclass(slots=True)
class Replayed:
    """A model as it was replayed.

    Attributes
    ----------
    folder : Path
        Of the model.
    commands : list of Command
    written : dict of str to str
        Texts of the files that the model wrote and reads as data, by name.
    mistake : Diagnostic or None
        Why the replay ended before the model did.
    """

    folder: Path = Path()
    commands: list[Command] = field(default_factory=list)
    written: dict[str, str] = field(default_factory=dict)
    mistake: Diagnostic | None = None


def replay(path: Path, shown: str, module: str, eigen: Eigen, seconds: float = SECONDS) -> Replayed:
    """Replay a model.

    Parameters
    ----------
    path : Path
        Of its file.
    shown : str
        Name of the file in messages.
    module : str
        ``tcl_model`` or ``python_model``.
    eigen : Eigen
        Answers the model's command `eigen`.
    seconds : float
        After which the process is ended.

    Returns
    -------
    Replayed
    """
    words = [sys.executable, "-P", "-m", f"{__package__}.{module}", str(path), str(seconds)]
    process = subprocess.Popen(
        words,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        encoding="utf-8",
        env={**os.environ, **_QUIET},
    )
    assert process.stdin and process.stdout
    replayed = Replayed(path.parent)
    folder = Path(shown).parent
    text = f"it was stopped after {seconds:g} s, or for its use of memory"
    end: Mapping[str, Any] = {"end": text, "limit": True}
    clock = Timer(seconds + 5.0, process.kill)
    clock.start()
    try:
        for line in process.stdout:
            try:
                item = json.loads(line)
            except ValueError:  # the process was ended within the line
                break
            if isinstance(item, list):
                words, file, number = item
                span = Span((folder / file).as_posix(), number, 1, 2)
                replayed.commands.append(Command(tuple(words), span))
            elif "written" in item:
                replayed.written[item["written"]] = item["text"]
            elif "eigen" in item:
                modes = eigen(replayed.commands, item["eigen"])
                answer = {"values": list(modes.values), "shapes": modes.shapes}
                process.stdin.write(json.dumps(answer) + "\n")
                process.stdin.flush()
            else:
                end = item
    except OSError:  # the process ended before it took the answer
        pass
    finally:
        clock.cancel()
        process.kill()
        process.communicate()
    if end["end"]:
        place = Span(
            (folder / end["file"]).as_posix() if end.get("file") else shown, end.get("line", 1), 1, 2
        )
        replayed.mistake = _mistake(end, place, any(c.name == "analyze" for c in replayed.commands))
    return replayed


def _mistake(end: Mapping[str, Any], place: Span, analysed: bool) -> Diagnostic:
    """Diagnostic of a replay that ended before the model; a warning where only results are asked for."""
    what = f"the model stops: {end['end']}"
    if end["limit"]:
        hint = (
            "nothing is solved in a replay: give a loop that waits for a displacement a count of its steps"
        )
        return Diagnostic("L621", what, place, hint)
    if analysed:
        hint = "what stands before it is read; results that a model asks for are zero here"
        return Diagnostic("L621", what, place, hint, "warning")
    return Diagnostic("L621", what, place)
