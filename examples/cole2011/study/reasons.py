"""Why statements of the paper hold or fail: a sentence each, with numbers of the readings' runs.

Numbers separated by semicolons are those of the readings, in their order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from statistics import fmean

from cases import APART, BENCHMARK, PAIR, TRADITIONAL
from errors import YIELD, Drift, Prediction, benchmark_of, drifts, predictions, worst
from gathered import Group, Study
from runs import STORED, Hit
from statements import FEW, mean, some

Groups = Mapping[str, Group]
GRAZE = 0.5 * PAIR.first.period  #: time up to which a touch is a graze [s]


class Reading:
    """Runs of one reading.

    Parameters
    ----------
    groups : mapping
        All tests of every record by its name.
    strength : float
        Storey yield over that of Table IV.
    disturbed : mapping
        By record the same tests under slightly disturbed records.
    """

    def __init__(self, groups: Groups, strength: float, disturbed: Mapping[str, Sequence[Group]]) -> None:
        self.groups, self.strength, self.disturbed = groups, strength, disturbed
        self.drifts = [d for g in groups.values() for d in drifts(g, benchmark_of(g), strength)]

    @property
    def hits(self) -> list[Hit]:
        """Collisions of the benchmark."""
        return [h for g in self.groups.values() for h in benchmark_of(g).hits]

    def ductility(self, record: str) -> float:
        """Largest drift of the benchmark over the yield drift."""
        bench = benchmark_of(self.groups[record])
        sides = (bench.left, bench.right)
        return max(x / (self.strength * YIELD[p[:2]]) for side in sides for p, x in side.items())

    def without_strongest(self) -> tuple[str, list[Drift]]:
        """Return the record that yields most, and the drifts under the others."""
        record = max(self.groups, key=self.ductility)
        return record, [d for d in self.drifts if d.record != record]

    def predictions(self, *tests: str, of: str = "peak", records: Iterable[str] = ()) -> list[Prediction]:
        """Eq. 11 at the approach speeds of some tests against the benchmark's forces above 1000 kN, under
        all records unless some are named.
        """
        found = [
            p
            for record in records or self.groups
            for run in self.groups[record]
            if run.test in tests
            for p in predictions(run, benchmark_of(self.groups[record]), PAIR.force, of)
        ]
        return [p for p in found if p.force > 1000]


def signed(found: Sequence[Prediction]) -> str:
    """Mean error with its sign [%]."""
    return f"{fmean(p.error for p in found):+.1f}" if found else "-"


def sizes(found: Sequence[Prediction]) -> str:
    """Mean size of errors [%]."""
    return f"{fmean(abs(p.error) for p in found):.1f}" if found else "-"


def traditional(readings: Sequence[Reading]) -> str:
    same = [sum(abs(d.error) < 0.05 for d in some(r.drifts, *TRADITIONAL)) for r in readings]
    total = len(some(readings[0].drifts, *TRADITIONAL))
    return (
        "Where a drift is largest before the first contact, no model has an error, so the statement cannot "
        f"hold of every location: below 0.05 % are {listed(same)} of {total} errors."
    )


def underestimate(readings: Sequence[Reading]) -> str:
    last = [min(some(r.drifts, *TRADITIONAL), key=lambda d: d.error) for r in readings]
    told = listed(f"{d.error:.0f} % ({d.test}, {d.place}, {d.record})" for d in last)
    return (
        "A wrong change of velocity gives the later motion another phase, which raises some peaks and "
        f"lowers others. The largest underestimates: {told}."
    )


def better(readings: Sequence[Reading]) -> str:
    told = [", ".join(f"{mean(some(r.drifts, t.name)):.2f}" for t in APART) + " %" for r in readings]
    off = 100 * (2 * PAIR.centroid / PAIR.first.period - 1)
    return (
        f"Its duration is right within {off:.0f} %, that of the traditional contacts is not; its "
        "restitution matters less. Mean errors of contacts with its restitution and T1, the exact "
        f"restitution and T1, its restitution and the exact centroid, and both exact: {listed(told)}."
    )


def one_element(readings: Sequence[Reading]) -> str:
    ones = [some(r.drifts, "1") for r in readings]
    return (
        "Both have too few degrees of freedom for waves. To be as accurate as one element is no accuracy: "
        f"its mean errors are {listed(f'{mean(x):.2f} %' for x in ones)}, its largest "
        f"{listed(f'{worst(x):.0f} %' for x in ones)}."
    )


def one_beyond(readings: Sequence[Reading]) -> str:
    largest = [max(some(r.drifts, "0(equiv)"), key=lambda d: abs(d.error)) for r in readings]
    told = listed(f"{d.error:+.1f} % ({d.place}, {d.record})" for d in largest)
    return (
        f"The limit cuts through the errors, and their places change with the damping. The largest: {told}."
    )


def far_ends(readings: Sequence[Reading]) -> str:
    ranges = []
    for r in readings:
        found = [difference(r.drifts)]
        for n in range(max((len(g) for g in r.disturbed.values()), default=0)):
            groups = {k: g[n] if n < len(g) else r.groups[k] for k, g in r.disturbed.items()}
            found.append(
                difference([d for g in groups.values() for d in drifts(g, benchmark_of(g), r.strength)])
            )
        ranges.append(f"{min(found):+.2f} to {max(found):+.2f} %")
    return (
        "The difference between far ends and interface is a fraction of a percent, and its sign is that of "
        "the reading. Ranges under records 1 % weaker or stronger, or a sample earlier or later: "
        f"{listed(ranges)}."
    )


def difference(found: Sequence[Drift]) -> float:
    """Mean error of 0(equiv) at the far ends less that at the interface [%]."""
    equiv = some(found, "0(equiv)")
    far, near = ([d for d in equiv if d.far == yes] for yes in (True, False))
    return mean(far) - mean(near)


def two_elements(readings: Sequence[Reading]) -> str:
    told = []
    for r in readings:
        large = [d for d in some(r.drifts, *FEW) if abs(d.error) >= 5]
        record = r.without_strongest()[0]
        told.append(f"{len(large)}, {sum(d.record == record for d in large)} of them under {record}")
    return (
        "Large errors need large plastic drifts: errors of 5 % or more, and those under the record that "
        f"yields most, are {listed(told)}."
    )


def progressive(readings: Sequence[Reading]) -> str:
    told = []
    for r in readings:
        record, found = r.without_strongest()
        if found:
            means = ", ".join(f"{mean(some(found, n)):.2f}" for n in ("1", *FEW))
            told.append(f"without {record} {means} %")
    return f"Where columns yield far, a small difference grows in any mesh. Mean errors: {listed(told)}."


def first_floor(readings: Sequence[Reading]) -> str:
    told = []
    for r in readings:
        touches = {name: [h for h in benchmark_of(g).hits if h.floor == 1] for name, g in r.groups.items()}
        some_of = ", ".join(
            f"{name} {len(hits)} (up to {max(h.peak for h in hits):.0f} kN)"
            for name, hits in touches.items()
            if hits
        )
        told.append(some_of or "none")
    return (
        "Where the gap is hardly closed, single touches decide. Touches of floor 1 and their largest "
        f"force: {listed(told)}."
    )


def yielding(readings: Sequence[Reading]) -> str:
    told = [", ".join(f"{r.ductility(name):.2f}" for name in r.groups) for r in readings]
    return (
        "The window of the records decides; the paper does not give it. Largest drift over yield drift "
        f"under {', '.join(readings[0].groups)}: {listed(told)}."
    )


def equation_11(readings: Sequence[Reading]) -> str:
    found = [r.predictions(BENCHMARK) for r in readings]
    stored = [", ".join(sizes(r.predictions(BENCHMARK, of=of)) for of in STORED) + " %" for r in readings]
    return (
        "The peak of a mesh of lumped masses overshoots the constant force of Eq. 11. The signed mean "
        f"errors are {listed(signed(x) + ' %' for x in found)}, their mean sizes "
        f"{listed(sizes(x) + ' %' for x in found)}. With the largest force stored every "
        f"{', '.join(STORED)}: {listed(stored)}."
    )


def weak_hits(readings: Sequence[Reading]) -> str:
    told = []
    for r in readings:
        weak = [h for h in r.hits if h.peak <= 1000]
        whole = [100 * (PAIR.force * h.approach / h.peak - 1) for h in weak if h.lasts >= GRAZE]
        rest = f"{fmean(map(abs, whole)):.1f} %" if whole else "-"
        told.append(f"{len(weak) - len(whole)} of {len(weak)}, {rest}")
    return (
        "Many large errors below 1000 kN are those of grazes: touches shorter than half of T1, in which "
        "the vibration of the floors' ends makes the force and not the approach of the floors. Grazes "
        f"among the touches below 1000 kN, and mean error of the others: {listed(told)}."
    )


def first_floor_hits(readings: Sequence[Reading]) -> str:
    counts = []
    for r in readings:
        hits = benchmark_of(r.groups["El Centro"]).hits
        counts.append(f"{sum(h.floor == 1 for h in hits)} and {sum(h.floor == 2 for h in hits)}")
    return f"Touches of floors 1 and 2 under El Centro: {listed(counts)}. So few decide nothing."


def alike(readings: Sequence[Reading]) -> str:
    told = []
    for r in readings:
        strong = [sum(h.peak > 1000 for h in benchmark_of(g).hits) for g in r.groups.values()]
        told.append(", ".join(map(str, strong)))
    return (
        "The overshoot of the mesh does not depend on the motion. Not all records have such collisions: "
        "above 1000 kN are under "
        f"{', '.join(readings[0].groups)}: {listed(told)}."
    )


def complexity(readings: Sequence[Reading]) -> str:
    names = ("1", *FEW, BENCHMARK)
    told = [
        ", ".join(signed(r.predictions(n, records=["El Centro"])) for n in names) + " %" for r in readings
    ]
    return (
        "The force is that of test 20 in all tests, and only the approach speed is the test's own. The "
        "overshoot therefore stays, however many elements there are; missed collisions count as -100 %. "
        f"Signed mean errors with {', '.join(names)} elements: {listed(told)}."
    )


def all_tests(readings: Sequence[Reading]) -> str:
    names = ("0(equiv)", "1", *FEW, BENCHMARK)
    told = []
    for r in readings:
        found = [r.predictions(*names, of=of, records=["El Centro"]) for of in ("peak", *STORED)]
        told.append(", ".join(f"{sum(abs(p.error) <= 10 for p in x)} of {len(x)}" for x in found))
    return (
        "The overshoot again. Within 10 % of the true peak, and of the largest force stored every "
        f"{', '.join(STORED)}: {listed(told)}."
    )


def major(readings: Sequence[Reading]) -> str:
    peaks = [max((h.peak for h in benchmark_of(r.groups["El Centro"]).hits), default=0.0) for r in readings]
    return (
        "The paper's own force is above 2000 kN, so its approach speed is above "
        f"{2000 / PAIR.force:.2f} m/s. The largest under El Centro: {listed(f'{x:.0f} kN' for x in peaks)}."
    )


REASONS: Mapping[str, Callable[[Sequence[Reading]], str]] = {
    "traditional": traditional,
    "underestimate": underestimate,
    "better": better,
    "one element": one_element,
    "one beyond": one_beyond,
    "far ends": far_ends,
    "two elements": two_elements,
    "progressive": progressive,
    "floor 1": first_floor,
    "yielding": yielding,
    "equation 11": equation_11,
    "weak hits": weak_hits,
    "first-floor hits": first_floor_hits,
    "alike": alike,
    "complexity": complexity,
    "all tests": all_tests,
    "major": major,
}


def listed(items: Iterable[object]) -> str:
    """Numbers of the readings, in their order."""
    return "; ".join(map(str, items))


def of_study(study: Study) -> list[Reading]:
    """Return the readings of a study."""
    disturbed: dict[str, dict[str, list[Group]]] = {}
    for (reading, record), groups in study.disturbed.items():
        disturbed.setdefault(reading, {})[record] = groups
    return [
        Reading(groups, study.strength[name], disturbed.get(name, {}))
        for name, groups in study.readings.items()
    ]


def reasons(study: Study) -> dict[str, str]:
    """Return the reason of each statement."""
    readings = of_study(study)
    return {key: reason(readings) for key, reason in REASONS.items()}


def first_force(study: Study) -> tuple[str, str]:
    """Return the mean errors of Eq. 11 against peaks and plateaus of the benchmark, for touches above
    1000 kN.
    """
    told = []
    for of in ("peak", "plateau"):
        means = []
        for r in of_study(study):
            strong = [h for h in r.hits if h.peak > 1000]
            errors = [100 * (PAIR.force * h.approach / h.force(of) - 1) for h in strong]
            means.append(f"{fmean(errors):+.0f} %" if errors else "-")
        told.append(listed(means))
    return told[0], told[1]
