"""Recorder of the process that replays a model: sends each command, and answers what the model asks.

The process writes a JSON value per line: ``[words, file, line]`` for a command, ``{"eigen": n}`` for a
question that the translating process answers with a line of its own, ``{"end": text, ...}`` last.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import pairwise
from typing import IO, Any, Final

from pound_import.opensees.names import COUNTS, RESULTS, SILENT
from pound_import.opensees.timeline import Timeline

MOST_COMMANDS: Final = 500_000
FILES: Final = ("-filePath", "-fileTime", "-file")  #: words before the names of files of data
MOST_RESULTS: Final = 12  #: numbers of one result
MOST_WORDS: Final = 200_000  #: of one command


class TooMuch(Exception):
    """The model is larger than a replay records."""


class CommandRecorder:
    """Commands of a model, on their way to the process that translates them.

    Parameters
    ----------
    to, answers : text streams
    written : function
        Text of a file that the model wrote; None where it wrote no such file.
    """

    def __init__(
        self, to: IO[str], answers: IO[str], written: Callable[[str], str | None] = lambda name: None
    ) -> None:
        self._to, self._answers, self.written = to, answers, written
        self._count = 0
        self._timeline = Timeline()
        self._coordinates: dict[int, list[str]] = {}
        self._masses: dict[int, list[str]] = {}
        self._elements: dict[int, list[str]] = {}
        self._shapes: dict[str, list[list[float]]] = {}

    def record(self, words: Sequence[str], file: str, line: int) -> list[str]:
        """Send a command; return the words of its answer.

        Raises
        ------
        TooMuch
            There are more commands than a plane frame has.
        """
        name = words[0]
        if name in SILENT:
            return []
        if name in COUNTS:
            return ["0"]
        if name in RESULTS:  # of one direction, or of all
            return ["0.0"] * (1 if len(words) > 2 and words[-1].isdigit() else MOST_RESULTS)
        if len(words) > MOST_WORDS:
            raise TooMuch(f"a command has more than {MOST_WORDS} words")
        question = _QUESTIONS.get(name)
        if question is not None:
            return question(self, [*words[1:], ""])
        self._count += 1
        if self._count > MOST_COMMANDS:
            raise TooMuch(f"the model has more than {MOST_COMMANDS} commands")
        for flag, path in pairwise(" ".join(words).split() if name in ("pattern", "timeSeries") else ()):
            if flag in FILES and (text := self.written(path)) is not None:
                self._send({"written": path, "text": text})
        self._send([list(words), file, line])
        self._timeline.take(words)
        self._keep(name, list(words))
        if name == "eigen":
            return self._eigen(words)
        return ["0"] if name == "analyze" else []

    def end(self, text: str = "", file: str = "", line: int = 0, limit: bool = False) -> None:
        """Send the end: without a text, as the model ends; with one, by a mistake or a limit at a place."""
        self._send({"end": text, "file": file, "line": line, "limit": limit})

    def _send(self, value: Any) -> None:
        self._to.write(json.dumps(value) + "\n")
        self._to.flush()

    def _keep(self, name: str, words: list[str]) -> None:
        """Keep what the model may ask for."""
        with suppress(ValueError, IndexError):
            if name == "node":
                self._coordinates[int(words[1])] = words[2:4]
            elif name == "mass":
                self._masses[int(words[1])] = words[2:5]
            elif name == "element":
                self._elements[int(words[2])] = words[3:5]
            elif name == "wipe":
                self._coordinates, self._masses, self._elements, self._shapes = {}, {}, {}, {}

    def _eigen(self, words: Sequence[str]) -> list[str]:
        """Squares of circular frequencies, which the other process computes."""
        count = next((word for word in reversed(words) if word.isdigit()), "1")
        self._send({"eigen": int(count)})
        answer = json.loads(self._answers.readline() or "{}")
        self._shapes = answer.get("shapes", {})
        values = [*answer.get("values", []), *[1.0] * int(count)]
        return [repr(float(value)) for value in values[: int(count)]]

    def _time(self, _: Sequence[str]) -> list[str]:
        return [repr(self._timeline.time)]

    def _coordinate(self, words: Sequence[str]) -> list[str]:
        return _chosen(self._coordinates.get(_tag(words[0]), ["0.0", "0.0"]), words[1])

    def _mass(self, words: Sequence[str]) -> list[str]:
        return _chosen(self._masses.get(_tag(words[0]), ["0.0"] * 3), words[1])

    def _displacement(self, words: Sequence[str]) -> list[str]:
        moved = self._timeline.moved
        return _chosen([repr(moved.get((_tag(words[0]), d), 0.0)) for d in (1, 2, 3)], words[1])

    def _shape(self, words: Sequence[str]) -> list[str]:
        modes = self._shapes.get(words[0], [])
        mode = _tag(words[1]) - 1
        shape = modes[mode] if 0 <= mode < len(modes) else [0.0, 0.0, 0.0]
        return _chosen([repr(value) for value in shape], (*words[2:3], "")[0])

    def _node_tags(self, _: Sequence[str]) -> list[str]:
        return [str(tag) for tag in self._coordinates]

    def _element_tags(self, _: Sequence[str]) -> list[str]:
        return [str(tag) for tag in self._elements]

    def _ends(self, words: Sequence[str]) -> list[str]:
        return self._elements.get(_tag(words[0]), [])

    def _two(self, _: Sequence[str]) -> list[str]:
        return ["2"]

    def _three(self, _: Sequence[str]) -> list[str]:
        return ["3"]

    def _bounds(self, _: Sequence[str]) -> list[str]:
        ends = [[float(c[k]) for c in self._coordinates.values()] or [0.0] for k in (0, 1)]
        return [repr(limit(axis)) for limit in (min, max) for axis in ends]


_QUESTIONS: Final = {
    "getTime": CommandRecorder._time,
    "nodeCoord": CommandRecorder._coordinate,
    "nodeMass": CommandRecorder._mass,
    "nodeDisp": CommandRecorder._displacement,
    "nodeEigenvector": CommandRecorder._shape,
    "getNodeTags": CommandRecorder._node_tags,
    "getEleTags": CommandRecorder._element_tags,
    "eleNodes": CommandRecorder._ends,
    "getNDM": CommandRecorder._two,
    "getNDF": CommandRecorder._three,
    "nodeBounds": CommandRecorder._bounds,
}


def _tag(word: str) -> int:
    try:
        return int(word)
    except ValueError:
        return 0


def _chosen(values: list[str], direction: str) -> list[str]:
    """One of the values by its direction from 1; all of them without a direction."""
    if not direction:
        return values
    k = _tag(direction.upper().translate(str.maketrans("XYZ", "123"))) - 1
    return [values[k]] if 0 <= k < len(values) else ["0.0"]
