"""Programs that stand still at a stated point, where a signal or a kill finds them."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

from heeding import HEEDING

HERE = b"stands\n"  #: what a program writes when it stands


class Standing:
    """A run of pound-solve in a process of its own, that stands still after some calls of one function.

    Parameters
    ----------
    place : str
        Module, class if there is one, and function, as ``pound_solve.sweep.session Session plan``.
    calls : int
        It stands after this call and after each later one.
    words : list of str
        The command line.
    how
        Of `subprocess.Popen`.
    """

    def __init__(self, place, calls, words, **how):
        tests = os.pathsep.join(filter(None, [str(Path(__file__).parent), os.environ.get("PYTHONPATH")]))
        self.process = subprocess.Popen(
            [sys.executable, "-m", "standing", place, str(calls), *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={**os.environ, "POUND_COMPILE": "0", "PYTHONPATH": tests},
            **HEEDING,
            **how,
        )

    def stands(self):
        """Wait until it stands; False where it has ended."""
        return self.process.stdout.readline() == HERE

    def resume_after_jump(self):
        """Let it go on to the next point."""
        self.process.stdin.write(b"\n")
        self.process.stdin.flush()

    def signal(self, number, group=False):
        """Send a signal, or one to its group as a terminal does; wait until the program has told of it."""
        send = os.killpg if group else os.kill
        send(self.process.pid, number)
        told = b""
        while b"ends with what it has" not in told:
            line = self.process.stderr.readline()
            assert line, told
            told += line
        return told

    def end(self):
        """Let it go on to its end without standing; its status, and what it told since."""
        _, told = self.process.communicate(timeout=300)  # the end of its input: it stands no more
        return self.process.returncode, told

    def kill(self):
        """Kill it where it stands."""
        self.process.kill()
        self.process.communicate()


def _stand_still(owner, name, calls):
    """Replace a function by one that writes and waits for a line, after some calls."""
    own, seen = getattr(owner, name), []

    def then_stand(*given, **options):
        result = own(*given, **options)
        seen.append(name)
        if len(seen) >= calls:
            sys.stdout.buffer.write(HERE)
            sys.stdout.flush()
            sys.stdin.readline()
        return result

    setattr(owner, name, then_stand)


if __name__ == "__main__":
    from pound_solve.cli.main import main

    module, *kind, function = sys.argv[1].split()
    owner = importlib.import_module(module)
    _stand_still(getattr(owner, kind[0]) if kind else owner, function, int(sys.argv[2]))
    sys.exit(main(sys.argv[3:]))
