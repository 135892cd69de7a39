"""Errors against the benchmark: drifts of every place and direction, and Eq. 11 against recorded forces."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from cases import BENCHMARK
from runs import PLACES, Hit, Run

#: collisions of two tests within this time are the same one [s]: half a period of building 1
TOGETHER = 0.1
YIELD = {"B1": 1e3 * 2400 / 420000, "B2": 1e3 * 1400 / 350000}  #: drift at yield [mm], Table IV


@dataclass(frozen=True)
class Drift:
    """Drift of a place in one direction, of a test, against the benchmark.

    Attributes
    ----------
    value : float
        Drift of the test [mm].
    error : float
        Relative to the benchmark's drift [%].
    scaled : float
        The same, relative to no less than half the yield drift [%].
    """

    record: str
    test: str
    place: str
    direction: str
    value: float
    error: float
    scaled: float

    @property
    def far(self) -> bool:
        """Whether the place is at the end of a building away from the other one."""
        return self.place.endswith("left") == self.place.startswith("B1")


def drifts(runs: Iterable[Run], benchmark: Run, strength: float = 1.0) -> Iterator[Drift]:
    """Every test's drifts against the benchmark of the same record; the yield is `strength` times that of
    Table IV.
    """
    for run in runs:
        for place in PLACES:
            for direction in ("left", "right"):
                value, exact = getattr(run, direction)[place], getattr(benchmark, direction)[place]
                error = 100 * (value / exact - 1) if exact > 0 else float("nan")
                scaled = 100 * (value - exact) / max(exact, 0.5 * strength * YIELD[place[:2]])
                yield Drift(run.record, run.test, place, direction, value, error, scaled)


@dataclass(frozen=True)
class Prediction:
    """Eq. 11 at a test's approach speed against the force that the benchmark recorded.

    Attributes
    ----------
    force : float
        Recorded force of the benchmark [kN].
    error : float
        Of the prediction [%]; -100 where the test has no such collision.
    """

    record: str
    test: str
    floor: int
    t: float
    force: float
    error: float


def predictions(run: Run, benchmark: Run, per_speed: float, of: str = "peak") -> Iterator[Prediction]:
    """Eq. 11 for every collision of the benchmark.

    Parameters
    ----------
    run : Run
        Gives the approach speeds.
    per_speed : float
        Force of Eq. 11 for a closing speed of one [kN s/m].
    of : str
        The force that is taken for the recorded one, as `Hit.force` has it.  Collisions that no sample
        meets are not recorded.
    """
    for hit in benchmark.hits:
        force = hit.force(of)
        if not force > 0.0:
            continue
        same = match(hit, run.hits) if run is not benchmark else hit
        error = 100 * (per_speed * same.approach / force - 1) if same else -100.0
        yield Prediction(run.record, run.test, hit.floor, hit.t, force, error)


def match(hit: Hit, others: Iterable[Hit]) -> Hit | None:
    """The collision of another test that is nearest in time, on the same floor."""
    near = [h for h in others if h.floor == hit.floor and abs(h.t - hit.t) <= TOGETHER]
    return min(near, key=lambda h: abs(h.t - hit.t), default=None)


def worst(found: Iterable[Drift]) -> float:
    """Largest error [%], of either sign."""
    return max((abs(d.error) for d in found), default=0.0)


def by_test(runs: Iterable[Run]) -> Mapping[str, Run]:
    """Runs of one record by the name of their test."""
    return {run.test: run for run in runs}


def benchmark_of(runs: Iterable[Run]) -> Run:
    """The benchmark among the runs of one record."""
    return by_test(runs)[BENCHMARK]
