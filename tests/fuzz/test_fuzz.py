"""A small tier of the fuzzer and of the kills; `make fuzz N=...` and `python -m fuzz.kills N` do more."""

from __future__ import annotations

import os
import signal
import sys
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from fuzz import judge as judges
from fuzz import workers
from fuzz.__main__ import SHARES, keep, tasks
from fuzz.cases import KINDS, bases, case
from fuzz.judge import Outcome, judge
from fuzz.kills import rounds
from fuzz.workers import outcomes
from tiers import at_night

#: cases of each kind, in two processes: one without runs and one with
COUNTS = (
    {"deck": 60, "verbs": 6, "editor": 2, "record": 30, "results": 8, "words": 8, "import": 12},
    {"run": 8, "options": 5, "study": 4, "texts": 3},
)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, bytes]:
    return bases(tmp_path_factory.mktemp("bases"))


@pytest.mark.full
@pytest.mark.parametrize("kind", KINDS)
def test_a_case_depends_on_its_seed_and_number_alone(whole: Mapping[str, bytes], kind: str) -> None:
    cases = [case(kind, 1, number, whole) for number in range(8)]
    assert cases == [case(kind, 1, number, whole) for number in range(8)]
    assert cases != [case(kind, 2, number, whole) for number in range(8)]


def test_every_kind_is_tried() -> None:
    assert {*COUNTS[0], *COUNTS[1]} == set(KINDS) == set(SHARES)


@pytest.mark.full
@pytest.mark.parametrize("counts", COUNTS, ids=["texts", "runs"])
def test_no_case_finds_a_fault(tmp_path: Path, whole: Mapping[str, bytes], counts: dict[str, int]) -> None:
    ends: Counter[tuple[str, str]] = Counter()
    for kind, number, outcome in outcomes(tasks(counts, 0), 1, 0, whole):
        ends[kind, outcome.end] += 1
        where = keep(tmp_path, kind, 0, number, outcome, whole) if outcome.fault else ""
        assert not outcome.fault, f"{where}: {outcome}"
    assert ends.total() == sum(counts.values())
    # of all kinds together: how many of a few cases of one kind are sound depends on all decks of the tests
    assert {"fine", "told"} <= {end for _, end in ends}, ends


def fault(case: object, folder: Path) -> Outcome:
    """What the program never does: each a fault that must be found."""
    print("pound-solve: a fault of the program, not of the deck")
    if os.environ["FAULT"] == "traceback":
        raise KeyError("x")
    if os.environ["FAULT"] == "memory":
        return Outcome("fine", str(len(bytearray(3 * 2**30))))
    if os.environ["FAULT"] == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    while True:
        pass


@pytest.mark.full
@pytest.mark.skipif(sys.platform != "linux", reason="bounds of this system")
@pytest.mark.parametrize("sort", ["traceback", "hang", *at_night("memory", "crash")])
def test_faults_are_found_and_the_next_case_is_judged(
    tmp_path: Path, whole: Mapping[str, bytes], monkeypatch: pytest.MonkeyPatch, sort: str
) -> None:
    """In a process of its own, whose judge of words is one with a fault at every second case."""
    monkeypatch.setenv("FAULT", sort)
    monkeypatch.setattr(workers, "serve", serve_with_faults)
    found = list(outcomes(iter([("words", 1), ("words", 2)]), 1, 0, whole))
    assert [(number, outcome.end) for _, number, outcome in found] == [(1, sort), (2, "fine")]
    folder = keep(tmp_path, *found[0][:1], 0, 1, found[0][2], whole)
    told = (folder / "fault.txt").read_text()
    assert told.startswith(sort) and "--only words 1" in told


def serve_with_faults(*args: object) -> None:
    def every_second(own: object, folder: Path) -> Outcome:
        return fault(own, folder) if getattr(own, "number", 0) % 2 else Outcome("fine")

    judges.JUDGES["words"] = every_second  # type: ignore[assignment]
    workers.LIMITS["words"] = 0.5
    workers.serve(*args)  # type: ignore[arg-type]


def test_words_that_no_user_should_see_are_faults(monkeypatch: pytest.MonkeyPatch) -> None:
    for text, status in (
        ("a fault of the program", 1),
        ("Traceback", 0),
        ("not enough memory", 1),
        ("", 2),
    ):
        monkeypatch.setattr(judges, "main", lambda words, t=text, s=status: print(t) or s)
        with pytest.raises(judges.Fault):
            judges.said("list", allowed=(0, 1, 2))


def test_results_that_are_not_finite_are_a_fault(
    tmp_path: Path, whole: Mapping[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    own = next(
        c for c in (case("run", 0, n, whole) for n in range(99)) if ends(c, tmp_path / str(c.number))
    )
    monkeypatch.setattr(judges, "np", SimpleNamespace(isfinite=lambda values: np.zeros(1, bool)))
    (tmp_path / "again").mkdir()
    assert judge(own, tmp_path / "again").end == "NaN"


def ends(own: object, folder: Path) -> bool:
    folder.mkdir()
    return judge(own, folder).end == "fine"  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="SIGKILL")
def test_kills_leave_older_results_or_whole_ones(tmp_path: Path) -> None:
    found = Counter(words for _, words, _ in rounds(tmp_path, 60, 0))
    assert not any(words.startswith("FAULT") for words in found), found
    assert len(found) > 2
