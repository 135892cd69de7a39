"""A sweep, or one of its processes, is killed amid its runs: nothing is lost, nothing is run twice."""

import json
import os
import select
import signal
from pathlib import Path

import pytest

from pound_solve.results.sweep_file import Sweep
from standing import Standing
from sweep.small import STUDY, folder
from sweep.test_sweep import same
from tiers import at_night

pytestmark = pytest.mark.full
LINUX = pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="finds processes by /proc")
#: 24 runs of some hundredths of a second
MANY = STUDY.replace("[0.01, 0.02]", "[0.01, 0.012, 0.014]")
pytest.importorskip("fcntl", reason="kills by signals")


ENDED = "pound_solve.sweep.execution.conduct Conductor _count"  #: called for every run that has ended
STARTED = "pound_solve.sweep.execution.executors process"  #: for every process that starts


def begun(path, calls, place=ENDED, **how):
    """A sweep that stands when some runs have ended, and at each later one; or at another place."""
    return Standing(place, calls, ["sweep", str(path), "--workers", "2", "--quiet"], **how)


def workers(process):
    """Numbers of the processes that a process has begun, but for the tracker of its resources."""
    out = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            number, _, rest = status.read_text().partition(" (")
            command = (status.parent / "cmdline").read_text()
        except OSError:
            continue
        if rest.rpartition(") ")[2].split()[1] == str(process.pid) and "spawn_main" in command:
            out.append(int(number))
    return out


def noted(path):
    """Identities of the runs that the journal holds, one for each line."""
    out = []
    for journal in (path.parent / "walls.sweep/runs").glob("*.jsonl"):
        whole = journal.read_bytes().rpartition(b"\n")[0]  # its process may be writing a line
        out += [json.loads(line)["identity"] for line in whole.splitlines()]
    return out


@LINUX
@pytest.mark.parametrize(
    "kills", [((3, 0),), *at_night((((2, None), (3, 0)),), (((1, 0), (3, 0), (2, -1)),))]
)
def test_a_sweep_that_is_killed_goes_on_where_it_was(tmp_path, kills):
    """Some times; where a number is given, after a worker of it was killed, which it survives."""
    (tmp_path / "undisturbed").mkdir()
    own = folder(tmp_path / "undisturbed", MANY)
    assert begun(own, 1).end()[0] == 0
    undisturbed = Sweep.open(own.parent / "walls.sweep/sweep.h5")
    path = folder(tmp_path, MANY)
    for calls, which in kills:
        sweep = begun(path, calls)
        assert sweep.stands()
        if which is not None:
            os.kill(workers(sweep.process)[which], signal.SIGKILL)
            sweep.resume_after_jump()
            assert sweep.stands()
        sweep.kill()
        assert calls <= len(noted(path)) < len(undisturbed)
    status, errors = begun(path, 1).end()
    assert status == 0, errors
    assert len(noted(path)) == len(set(noted(path))) == len(undisturbed)
    assert same(undisturbed, Sweep.open(path.parent / "walls.sweep/sweep.h5"))


@LINUX
def test_workers_end_with_the_sweep_that_began_them(tmp_path):
    sweep = begun(folder(tmp_path, MANY), 3)
    assert sweep.stands()
    own = [os.pidfd_open(n) for n in workers(sweep.process)]
    assert len(own) == 2
    sweep.kill()
    for process in own:
        assert select.select([process], [], [], 60.0)[0], "a worker goes on"  # readable when it has ended
        os.close(process)


def test_an_interruption_ends_the_runs_that_have_begun_and_writes_the_table(tmp_path):
    path = folder(tmp_path, MANY)
    sweep = begun(path, 3)
    assert sweep.stands()
    sweep.signal(signal.SIGINT)
    status, errors = sweep.end()
    assert status == 1, errors
    done = noted(path)
    assert 3 <= len(done) < 24 and len(set(done)) == len(done)
    found = Sweep.open(tmp_path / "walls.sweep/sweep.h5")
    assert sorted(found["identity"][found["status"] == "done"]) == sorted(done)
    assert set(found["status"]) == {"done", "missing"}


@pytest.mark.parametrize("calls", [2, *at_night(1)])
def test_an_interruption_while_workers_start_leaves_no_traceback(tmp_path, calls):
    """Ctrl-C of a terminal goes to all processes of the group, those that read their modules among them."""
    path = folder(tmp_path, MANY)
    sweep = begun(path, calls, STARTED, start_new_session=True)
    assert sweep.stands()
    told = sweep.signal(signal.SIGINT, group=True)
    status, rest = sweep.end()
    assert b"Traceback" not in told + rest, rest.decode()
    assert status == 1
