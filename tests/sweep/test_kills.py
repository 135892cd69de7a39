"""A sweep, or one of its processes, is killed at random moments: nothing is lost, nothing is run twice."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from heeding import HEEDING
from pound_solve.results.sweep_file import Sweep
from sweep.small import STUDY, folder
from sweep.test_sweep import same

pytestmark = pytest.mark.full
KILLS = 20
#: 64 runs of some hundredths of a second
MANY = STUDY.replace("[0.01, 0.02]", "[0.01, 0.012, 0.014, 0.016, 0.018, 0.02, 0.025, 0.03]").replace(
    "[1, 2.5]", "[1, 2.5]\n"
)
pytest.importorskip("fcntl", reason="kills by signals")


def begun(path, **how):
    words = [sys.executable, "-m", "pound_solve", "sweep", str(path), "--workers", "2", "--quiet"]
    env = {**os.environ, "POUND_COMPILE": "0"}
    return subprocess.Popen(words, env=env, stderr=subprocess.PIPE, **HEEDING, **how)


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


def at_a_moment(process, path, dice):
    """Wait for a random moment of a sweep that has runs ahead; whether it still goes on then."""
    before, wanted = len(noted(path)), dice.randint(0, 5)
    while process.poll() is None and len(noted(path)) < before + wanted:
        time.sleep(0.002)
    time.sleep(dice.uniform(0.0, 0.03))
    return process.poll() is None


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="finds processes by /proc")
def test_a_sweep_that_is_killed_goes_on_where_it_was(tmp_path):
    (tmp_path / "undisturbed").mkdir()
    begun(own := folder(tmp_path / "undisturbed", MANY)).communicate(timeout=300)
    undisturbed = Sweep.open(own.parent / "walls.sweep/sweep.h5")
    path, dice, kills = folder(tmp_path, MANY), random.Random(17), {"sweep": 0, "worker": 0}
    while sum(kills.values()) < KILLS:
        process = begun(path)
        while at_a_moment(process, path, dice) and sum(kills.values()) < KILLS:
            own = workers(process)
            if own and dice.random() < 0.5:
                os.kill(dice.choice(own), signal.SIGKILL)
                kills["worker"] += 1
                continue
            process.send_signal(signal.SIGKILL)
            kills["sweep"] += 1
            break
        process.communicate()
        if len(set(noted(path))) == len(undisturbed):  # all done: begin anew
            finish(path, undisturbed)
            for old in (path.parent / "walls.sweep/runs").iterdir():
                old.unlink()
    finish(path, undisturbed)
    assert min(kills.values()) >= 3, kills


def finish(path, undisturbed):
    """Run what is left; nothing stands twice in the journal, the table is that of an undisturbed sweep."""
    process = begun(path)
    _, errors = process.communicate(timeout=300)
    assert process.returncode == 0, errors
    assert len(noted(path)) == len(set(noted(path))) == len(undisturbed)
    assert same(undisturbed, Sweep.open(path.parent / "walls.sweep/sweep.h5"))


def test_workers_end_with_the_sweep_that_began_them(tmp_path):
    path = folder(tmp_path, MANY)
    process = begun(path)
    while len(noted(path)) < 3:
        time.sleep(0.01)
    own = workers(process)
    assert len(own) == 2
    process.kill()
    process.communicate()
    limit = time.monotonic() + 20.0
    while any(Path(f"/proc/{n}/stat").exists() for n in own):
        assert time.monotonic() < limit
        time.sleep(0.01)


def test_an_interruption_ends_the_runs_that_have_begun_and_writes_the_table(tmp_path):
    path = folder(tmp_path, MANY)
    process = begun(path)
    while len(noted(path)) < 3:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 1, errors
    done = noted(path)
    assert 3 <= len(done) < 64 and len(set(done)) == len(done)
    found = Sweep.open(tmp_path / "walls.sweep/sweep.h5")
    assert sorted(found["identity"][found["status"] == "done"]) == sorted(done)
    assert set(found["status"]) == {"done", "missing"}


def test_an_interruption_while_workers_start_leaves_no_traceback(tmp_path):
    """Ctrl-C of a terminal goes to all processes of the group, those that read their modules among them."""
    path, dice = folder(tmp_path, MANY), random.Random(5)
    amid = 0
    for _ in range(12):
        process = begun(path, start_new_session=True)
        limit = time.monotonic() + 60.0
        while not (own := workers(process)) and time.monotonic() < limit:
            time.sleep(0.002)
        time.sleep(dice.uniform(0.0, 0.4))
        before = len(noted(path))
        amid += bool(own) and before == 0
        os.killpg(process.pid, signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        assert b"Traceback" not in errors, errors.decode()
        assert process.returncode == 1, errors.decode()
        for old in (path.parent / "walls.sweep/runs").glob("*.jsonl"):
            old.unlink()
    assert amid >= 3
