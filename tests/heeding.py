"""Default handling of signals in tests: a shell that starts them in the background has some ignored."""

import os
import signal


def heed():
    """Let the present process heed all signals that end one; between fork and exec of another."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_DFL)


#: of `subprocess.Popen`: begins a process that heeds signals
HEEDING = {"preexec_fn": heed} if os.name == "posix" else {}
