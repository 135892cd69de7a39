"""Verbs that choose their runs are killed at random moments: nothing is lost, nothing is run twice."""

import random
import shutil

import pytest

from standing import Standing
from sweep import test_calibrate, test_optimize, test_sensitivity, test_uncertainty
from sweep.small import folder
from sweep.test_kills import ENDED, noted

pytestmark = pytest.mark.slow
pytest.importorskip("fcntl", reason="kills by signals")
KILLS = 5


def of_sensitivity(to):
    return test_sensitivity.study(to, "gap = {}\nk = {}")


def of_calibrate(to):
    test_calibrate.test_file(to, 4)
    return test_calibrate.study(to)


def of_uncertainty(to):
    return folder(to, test_uncertainty.WALL)


def of_optimize(to):
    return folder(to, test_optimize.WALL)


STUDIES = {
    "sensitivity": of_sensitivity,
    "calibrate": of_calibrate,
    "uncertainty": of_uncertainty,
    "optimize": of_optimize,
}


@pytest.mark.parametrize("verb", STUDIES)
def test_a_verb_that_is_killed_five_times_goes_on_where_it_was(tmp_path, verb):
    """It ends with the files of an undisturbed call, to the last byte, and with its runs."""

    def begun(path, calls):
        return Standing(ENDED, calls, [verb, str(path), "--workers", "2", "--quiet"])

    (tmp_path / "undisturbed").mkdir()
    path = STUDIES[verb](tmp_path / "undisturbed")
    assert begun(path, 10**6).end()[0] == 0
    whole = noted(path)
    (tmp_path / "killed").mkdir()
    shutil.copytree(path.parent, tmp_path / "killed", dirs_exist_ok=True)
    killed = tmp_path / "killed" / path.name
    shutil.rmtree(killed.parent / "walls.sweep")
    moments = random.Random(7)
    for _ in range(KILLS):
        before = len(noted(killed))
        call = begun(killed, moments.randint(1, 4))
        assert call.stands()
        call.kill()
        assert before < len(noted(killed)) < len(whole)
    status, errors = begun(killed, 10**6).end()
    assert status == 0, errors
    assert sorted(noted(killed)) == sorted(whole) and len(set(whole)) == len(whole)
    for ending in ("rpt", "csv"):
        old, new = ((p.parent / f"walls.sweep/{verb}.{ending}").read_bytes() for p in (path, killed))
        assert old == new
