"""Sweeps by the workers of a real Dask scheduler: the same table, also where a worker is killed amid it."""

import json
import os
import subprocess
import sys
import time

import pytest

from pound_solve.results.sweep_file import Sweep
from pound_solve.sweep.execution import executors
from sweep.small import folder, swept
from sweep.test_sweep import same

pytestmark = pytest.mark.slow
pytest.importorskip("distributed")


def started(*words):
    environment = {**os.environ, "POUND_COMPILE": "0", "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "5"}
    return subprocess.Popen([sys.executable, "-m", *words], env=environment)


def scheduled(file, port=0):
    """A scheduler that listens, and notes its address in a file."""
    words = ("--port", str(port), "--no-dashboard", "--scheduler-file", str(file))
    process = started("distributed.cli.dask_scheduler", *words)
    while not file.exists():
        time.sleep(0.1)
    return process


@pytest.fixture
def cluster(tmp_path):
    """File of a scheduler's address, and all processes, the scheduler first."""
    file = tmp_path / "scheduler.json"
    running = [scheduled(file)]
    yield file, running
    end(running)


def end(processes):
    for process in processes:
        process.kill()
        process.wait()


def workers(file, count, threads=1):
    words = ("--nthreads", str(threads), "--no-dashboard", "--no-nanny", "--scheduler-file", str(file))
    return [started("distributed.cli.dask_worker", *words) for _ in range(count)]


def address(file):
    return "dask://" + json.loads(file.read_text())["address"].removeprefix("tcp://")


def rounds(path, file, out):
    words = ["sweep", str(path), "--executor", address(file), "-o", str(out), "--quiet"]
    return started("pound_solve", *words)


def journal(out):
    return sum(len(p.read_bytes().splitlines()) for p in (out / "runs").glob("*.jsonl"))


def until(process, true):
    """Wait until something is true; the process must not end before."""
    while not true():
        time.sleep(0.005)
        assert process.poll() is None


def test_workers_of_a_scheduler_give_the_same_table(tmp_path, cluster):
    path, (file, running) = folder(tmp_path), cluster
    here = Sweep.open(swept(path).write())
    running += workers(file, 2)
    assert rounds(path, file, tmp_path / "out").wait(300) == 0
    assert same(here, Sweep.open(tmp_path / "out/sweep.h5"))


def test_a_worker_that_is_killed_costs_no_run(tmp_path, cluster):
    path, (file, running) = folder(tmp_path), cluster
    here = Sweep.open(swept(path).write())
    running += workers(file, 3)
    sweep = rounds(path, file, tmp_path / "out")
    until(sweep, lambda: journal(tmp_path / "out") >= 4)
    end(running[1:2])
    assert sweep.wait(300) == 0
    assert same(here, Sweep.open(tmp_path / "out/sweep.h5"))
    assert journal(tmp_path / "out") == 16


def test_a_sweep_goes_on_with_a_scheduler_that_was_restarted(tmp_path, cluster):
    path, (file, running) = folder(tmp_path), cluster
    here = Sweep.open(swept(path).write())
    port = address(file).rpartition(":")[2]
    running += workers(file, 2)
    sweep = rounds(path, file, tmp_path / "out")
    until(sweep, lambda: journal(tmp_path / "out") >= 4)
    end(running)
    file.unlink()
    running.append(scheduled(file, port))
    running += workers(file, 2)
    assert sweep.wait(300) == 0
    assert same(here, Sweep.open(tmp_path / "out/sweep.h5"))
    assert journal(tmp_path / "out") == 16


def test_threads_of_one_worker_do_not_mix_their_runs(tmp_path, cluster):
    path, (file, running) = folder(tmp_path), cluster
    here = Sweep.open(swept(path).write())
    running += workers(file, 1, threads=3)
    assert rounds(path, file, tmp_path / "out").wait(300) == 0
    assert same(here, Sweep.open(tmp_path / "out/sweep.h5"))


def test_a_scheduler_that_does_not_answer_is_told(monkeypatch):
    monkeypatch.setattr(executors, "PATIENCE", 1.0)
    with pytest.raises(executors.ExecutorError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9"):
        executors.engine("dask://127.0.0.1:9", 1).start()
