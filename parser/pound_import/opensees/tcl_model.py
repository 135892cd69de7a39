"""Process that replays a model in Tcl: ``python -m pound_import.opensees.tcl_model FILE SECONDS``.

The file runs in a safe interpreter of Tcl, which has no command that reaches the machine.  ``source`` and
``open`` read files of the model's folder only; what it writes stays in memory.  Limits of time and memory
end it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

with suppress(ImportError):  # without it `main` says so
    from tkinter import Tcl, TclError

from pound_deck.files import contents
from pound_import.opensees.limits import limited
from pound_import.opensees.names import EVERY
from pound_import.opensees.recorder import CommandRecorder, TooMuch
from pound_import.opensees.tcl_files import Files

#: of the interpreter around the safe one: what Python answers, or its mistake
_AROUND: Final = """
proc answered {name args} {
    lassign [answer $name {*}$args] fails text
    if {$fails} { return -code error $text }
    return $text
}
"""
#: procedures of the safe interpreter whose effect is within the caller
_PROCEDURES: Final = """
proc gets {channel args} {
    lassign [line_of_channel $channel] text length
    if {[llength $args] == 0} { return $text }
    upvar 1 [lindex $args 0] line
    set line $text
    return $length
}
proc pattern {args} {
    set body [lindex $args end]
    if {[lindex $args 0] in {Plain MultipleSupport MultiSupport} && [llength $args] > 3} {
        record_command pattern {*}[lrange $args 0 end-1]
        uplevel 1 $body
    } else {
        record_command pattern {*}$args
    }
    return
}
proc section {args} {
    if {[lindex $args 0] in {Fiber fiberSec NDFiber FiberThermal} && [llength $args] > 2} {
        record_command section {*}[lrange $args 0 end-1]
        uplevel 1 [lindex $args end]
    } else {
        record_command section {*}$args
    }
    return
}
proc pset {name value} { uplevel 1 [list set $name $value] }
proc unknown {args} { return [record_command {*}$args] }
proc after {args} { return {} }
proc vwait {args} { return {} }
proc update {args} { return {} }
expr {srand(1)}
"""
NO_TCL: Final = "this Python has no tkinter, which holds the interpreter of Tcl"
_BODIED: Final = ("pattern ", "section ")  #: commands whose last word is a script
_GONE: Final = ("fileevent", "fcopy", "fblocked", "chan", "zlib", "seek", "tell", "interp", "package")


class TclModel:
    """A model in a safe interpreter.

    Parameters
    ----------
    path : Path
        Its file.
    recorder : CommandRecorder
    """

    def __init__(self, path: Path, recorder: CommandRecorder) -> None:
        self._path, self._recorder = path, recorder
        self._files = files = Files(path.parent)
        recorder.written = files.of_the_model
        self._tcl: Any = Tcl()
        self._tcl.eval("interp create -safe model")
        self._ended = False
        self._too_much = ""
        for name in _GONE:
            self._tcl.eval(f"interp eval model {{rename {name} {{}}}}")
        self._answers: dict[str, Callable[..., Any]] = {
            "record_command": self._record,
            "line_of_channel": files.line,
            "source": self._source,
            "exit": self._exit,
            "open": files.open,
            "close": files.close,
            "puts": files.puts,
            "read": files.read,
            "eof": lambda channel: int(files.eof(channel)),
            "cd": files.cd,
            "file": files.file,
            "pwd": lambda: ".",
            **dict.fromkeys(("glob", "exec", "package", "flush", "fconfigure"), lambda *_: ""),
        }
        self._tcl.createcommand("answer", self._answer)
        self._tcl.eval(_AROUND)
        for name in self._answers:
            self._tcl.eval(f"interp alias model {name} {{}} answered {name}")
        for name in (*EVERY, "load"):
            if name not in ("pattern", "section"):
                self._tcl.eval(f"interp alias model {name} {{}} answered record_command {name}")
        self._tcl.eval(f"interp eval model {{{_PROCEDURES}}}")

    def run(self, seconds: float) -> None:
        """Replay the file; its end goes to the recorder."""
        self._tcl.eval(f"interp limit model time -seconds [expr {{[clock seconds] + {int(seconds)}}}]")
        try:
            self._source(self._path.name)
        except (TclError, OSError) as error:
            if not self._ended:
                text = self._too_much or str(error)
                late = text in ("", "time limit exceeded")  # none within a command that Python answers
                text = f"it takes more than {seconds:g} s" if late else text
                self._recorder.end(text, *self._stop_of_model(), limit=late or bool(self._too_much))
                return
        self._recorder.end()

    def _answer(self, name: str, *words: Any) -> tuple[int, Any]:
        """Answer a command: 0 and its value, or 1 and its mistake; too many commands end the replay."""
        try:
            return 0, self._answers[name](*words)
        except TooMuch as error:
            self._too_much = str(error)
            self._tcl.eval("interp limit model commands -value 1")
        except (OSError, TclError, ValueError, TypeError) as error:
            return 1, str(error)
        return 1, self._too_much

    def _record(self, *words: Any) -> list[str] | str:
        """Record a command with the place in a file that called it."""
        answer = self._recorder.record([str(word) for word in words], *self._here())
        return answer[0] if len(answer) == 1 else answer

    def _here(self) -> tuple[str, int]:
        """File and line of the innermost command that stands in a file; lines of a body count from it."""
        depth = int(self._tcl.eval("interp eval model {info frame}"))
        within = 1
        for level in range(depth, 0, -1):
            try:
                words = self._tcl.splitlist(self._tcl.eval(f"interp eval model {{info frame {level}}}"))
            except TclError:
                continue
            frame = dict(zip(words[::2], words[1::2]))
            line = int(frame.get("line", 1))
            if frame.get("file"):
                bodied = str(frame.get("cmd", "")).startswith(_BODIED)
                return self._named(str(frame["file"])), line + (within - 1 if bodied else 0)
            if frame.get("type") == "eval" and within == 1:
                within = line
        return self._path.name, 1

    def _named(self, file: str) -> str:
        """Name of a file relative to the folder of the model."""
        path = Path(file)
        return (
            path.relative_to(self._files.folder).as_posix()
            if path.is_relative_to(self._files.folder)
            else path.name
        )

    def _stop_of_model(self) -> tuple[str, int]:
        """File and line of the mistake that ended the model."""
        for kind, value in (("time", "-seconds"), ("commands", "-value")):  # else nothing more is evaluated
            self._tcl.eval(f"interp limit model {kind} {value} {{}}")
        trace = self._tcl.eval("interp eval model {expr {[info exists ::errorInfo] ? $::errorInfo : {}}}")
        file, line = self._path.name, 1
        for text in trace.splitlines():
            text = text.strip()
            if text.startswith('(file "'):
                name, _, rest = text[7:].partition('" line ')
                number = rest.rstrip(")")
                return self._named(name), int(number) if number.isdigit() else 1
        return file, line

    def _source(self, *words: str) -> str:
        """Run a file of the folder, in its own encoding."""
        name = words[-1]
        path = self._files.path(name)
        if path != self._path and path not in self._files.written and not path.is_file():
            return str(self._record("source", name))
        if path in self._files.written:
            return str(self._tcl.call("interp", "eval", "model", self._files.text(name)))
        self._files.text(name)  # raises where the file cannot be read
        try:
            contents(path).decode("utf-8")
            encoding = "utf-8"
        except UnicodeDecodeError:
            encoding = "iso8859-1"
        command = ("interp", "invokehidden", "model", "source", "-encoding", encoding, str(path))
        return str(self._tcl.call(*command))

    def _exit(self, *_: str) -> str:
        """End the replay as the model asks."""
        self._ended = True
        self._tcl.eval("interp limit model commands -value 1")
        return ""


def main() -> None:
    """Read the command line and replay the file."""
    file, seconds = sys.argv[1], float(sys.argv[2])
    limited(seconds)
    recorder = CommandRecorder(sys.stdout, sys.stdin)
    if "Tcl" in globals():
        TclModel(Path(file).resolve(), recorder).run(seconds)
    else:
        recorder.end(NO_TCL)


if __name__ == "__main__":
    main()
