"""Process that replays a model in Python: ``python -m pound_import.opensees.python_model FILE SECONDS``.

The file is executed.  Its `openseespy.opensees` is a module that records, and its libraries of pictures and
of postprocessing do nothing; whatever else the file does is done, within limits of time and memory.
"""

from __future__ import annotations

import os
import runpy
import sys
import traceback
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType
from typing import Any, Final

from pound_import.opensees.limits import limited
from pound_import.opensees.names import EVERY
from pound_import.opensees.recorder import CommandRecorder, TooMuch

#: names under which scripts import OpenSees
_NAMES: Final = ("openseespy.opensees", "opensees", "openseespylinux.opensees", "openseespywin.opensees")
#: libraries that draw models and results
_DRAWING: Final = (
    "opsvis",
    "vfo",
    "vfo.vfo",
    "opstool",
    "openseespy.postprocessing",
    "openseespy.preprocessing",
)
#: commands whose answer is a list, be it of one item
_LISTS: Final = ("eigen", "getNodeTags", "getEleTags", "eleNodes")


class PythonModel:
    """A model in Python.

    Parameters
    ----------
    path : Path
        Its file.
    recorder : CommandRecorder
    """

    def __init__(self, path: Path, recorder: CommandRecorder) -> None:
        self._path, self._recorder = path, recorder

    def run(self) -> None:
        """Execute the file; its end goes to the recorder."""
        self._install()
        os.chdir(self._path.parent)
        sys.path.insert(0, str(self._path.parent))
        sys.argv = [str(self._path)]
        try:
            runpy.run_path(str(self._path), run_name="__main__")
        except SystemExit:
            pass
        except BaseException as error:  # whatever the file raises ends the replay
            limit = isinstance(error, TooMuch)
            text = str(error) if limit else f"{type(error).__name__}: {error}"
            self._recorder.end(text, *self._place(traceback.extract_tb(error.__traceback__)), limit=limit)
            return
        self._recorder.end()

    def _install(self) -> None:
        """Put the recording module, and empty ones for pictures, in place of the libraries."""
        recording = _Recording("opensees", self._recorded)
        for name in EVERY:
            setattr(recording, name, self._recorded(name))
        recording.__dict__["__all__"] = list(EVERY)
        package = ModuleType("openseespy")
        package.__path__ = []
        package.__dict__["opensees"] = recording
        sys.modules["openseespy"] = package
        sys.modules.update(dict.fromkeys(_NAMES, recording))
        for name in _DRAWING:
            sys.modules[name] = _Nothing(name)
            sys.modules[name].__path__ = []

    def _recorded(self, name: str) -> Callable[..., Any]:
        """Return the function that records a command."""

        def command(*words: Any) -> Any:
            here = self._place(traceback.extract_stack()[:-1])
            answer = self._recorder.record([name, *_texts(words)], *here)
            values = [_value(word) for word in answer]
            if len(values) == 1 and name not in _LISTS:
                return values[0]
            return values or None

        return command

    def _place(self, frames: Iterable[traceback.FrameSummary]) -> tuple[str, int]:
        """File of the folder and line of the innermost frame that stands in one."""
        folder = self._path.parent
        for frame in reversed(list(frames)):
            path = Path(frame.filename)
            if path.is_absolute() and path.is_relative_to(folder) and "site-packages" not in path.parts:
                return path.relative_to(folder).as_posix(), frame.lineno or 1
        return self._path.name, 1


class _Recording(ModuleType):
    """A module that records its functions, those too that are not known."""

    def __init__(self, name: str, recorded: Callable[[str], Callable[..., Any]]) -> None:
        super().__init__(name)
        self._recorded = recorded

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return self._recorded(name)


class _Nothing(ModuleType):
    """A module whose every function does nothing."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *words, **items: None


def _texts(words: Iterable[Any]) -> Iterable[str]:
    """Words of a command; lists give one word each of their items."""
    for word in words:
        if isinstance(word, str):
            yield word
        elif hasattr(word, "__iter__"):
            yield from _texts(word)
        elif isinstance(word, bool) or hasattr(word, "__index__"):
            yield str(int(word))
        else:
            yield repr(float(word))


def _value(word: str) -> Any:
    """Number of an answer."""
    return int(word) if word.lstrip("-").isdigit() else float(word)


def main() -> None:
    """Read the command line and replay the file; what it prints is dropped."""
    file, seconds = sys.argv[1], float(sys.argv[2])
    limited(seconds)
    recorder = CommandRecorder(
        os.fdopen(os.dup(1), "w", encoding="utf-8"), os.fdopen(os.dup(0), encoding="utf-8")
    )
    with open(os.devnull, "w", encoding="utf-8") as nothing:
        os.dup2(nothing.fileno(), 1)
        PythonModel(Path(file).resolve(), recorder).run()


if __name__ == "__main__":
    main()
