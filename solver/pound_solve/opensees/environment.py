"""Run a script for OpenSeesPy in the environment that the user names."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any, Final, NamedTuple

from pound_solve.user_error import UserError

PROBE: Final = "import openseespy.opensees as ops; print(ops.version())"
TAIL: Final = 3  #: lines of the error stream in a message


class OpenSeesError(UserError):
    """Raised if OpenSees cannot be started, or stops."""

    status = 1


class OpenSeesRun(NamedTuple):
    """What a script printed: version of OpenSees, step [T] and peaks by name."""

    program: str
    dt: float
    peaks: dict[str, float]


def version(python: str) -> str:
    """Version of OpenSees that an interpreter loads.

    Raises
    ------
    OpenSeesError
        There is no such interpreter, or it has no openseespy.
    """
    done = _output([python, "-c", PROBE])
    if done.returncode or not done.stdout.strip():
        hint = f"{python} -m pip install openseespy, or name another interpreter with --python"
        (why,) = done.stderr.strip().splitlines()[-1:] or ("it says nothing",)
        raise OpenSeesError(f"{python} has no OpenSees ({why[:200]}): {hint}")
    return done.stdout.split()[-1]


def run(python: str, script: Path, dt: float) -> OpenSeesRun:
    """Run a script with a time step.

    Raises
    ------
    OpenSeesError
        The script stops; the message gives the time that it reached.
    """
    done = _output([python, str(script), "--dt", repr(dt)])
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode or not lines:
        said = [x for x in done.stderr.splitlines() if x.startswith(("OpenSees", "the "))]
        raise OpenSeesError(f"OpenSees stops at dt={dt:g}: {said[-1] if said else _tail(done.stderr)}")
    try:
        said_by: dict[str, Any] = json.loads(lines[-1])
        return OpenSeesRun(**said_by)
    except (ValueError, TypeError):
        raise OpenSeesError(f"OpenSees prints no peaks at dt={dt:g}: {lines[-1][:200]}") from None


def _output(command: list[str]) -> subprocess.CompletedProcess[str]:
    """Run a command and return its streams."""
    try:
        return subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    except OSError as err:
        raise OpenSeesError(f"'{command[0]}' cannot be started: {err.strerror or err}") from None


def _tail(text: str) -> str:
    """Last lines of a text in one line."""
    lines = [line.strip() for line in text.splitlines() if line.strip() and "Terminating" not in line]
    return "; ".join(lines[-TAIL:])[:300] or "it says nothing"
