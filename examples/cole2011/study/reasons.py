"""Why statements of the paper hold or fail: a sentence each, with numbers of the readings' runs.

Numbers separated by semicolons are those of the readings, in their order.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from statistics import fmean

from cases import BENCHMARK, KD1, PAIR, TRADITIONAL
from errors import YIELD, Drift, Prediction, benchmark_of, drifts, match, predictions, worst
from gathered import Group, Study
from robustness import Cells
from runs import STORED, Hit, Run
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

    def without_strongest(self) -> tuple[str, list[Drift]]:
        """Return the record that yields most, and the drifts under the others."""
        record = max(self.groups, key=lambda r: ductility(benchmark_of(self.groups[r]), self.strength))
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


def ductility(run: Run, strength: float) -> float:
    """Largest drift of a run over the yield drift."""
    return max(x / (strength * YIELD[p[:2]]) for side in (run.left, run.right) for p, x in side.items())


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
    force = 2.0 * PAIR.centroid
    times = [math.pi * (PAIR.mass / (x * KD1)) ** 0.5 / force for x in (10.0, 1.0, 0.1)]
    return (
        f"The traditional contacts return e = 1, floors {PAIR.e:.3f} and 0(equiv) {PAIR.e_paper:.3f}; and "
        f"they last {listed(f'{x:.2f}' for x in times)} times as long as the floors' force (0(10), 0(1), "
        "0(0.1)). 0(1) lasts as long as 0(equiv) and is the less accurate, so restitution is what differs. "
        "Section 2 shows that the step from Eq. 14 to the exact restitution is too small to tell."
    )


def one_element(readings: Sequence[Reading]) -> str:
    ones = [some(r.drifts, "1") for r in readings]
    return (
        "Both have too few degrees of freedom for waves, and one element is itself inaccurate: its mean "
        f"errors are {listed(f'{mean(x):.2f} %' for x in ones)}, its largest "
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


def two_elements(cells: Cells) -> str:
    elastic, plastic = [], []
    for (structure, _), group in cells.items():
        bench = benchmark_of(group)
        error = worst(some(list(drifts(group, bench, structure.strength)), *FEW))
        (elastic if ductility(bench, structure.strength) < 1.0 else plastic).append(error)
    return (
        "Errors of 5 % or more occur without yielding, and are largest with it. Of all structures under "
        f"all records {beyond(elastic)} without yielding and {beyond(plastic)} with it have one."
    )


def beyond(errors: Sequence[float]) -> str:
    """How many errors are 5 % or more, and the largest."""
    return f"{sum(e >= 5 for e in errors)} of {len(errors)} (up to {max(errors, default=0.0):.0f} %)"


def progressive(readings: Sequence[Reading]) -> str:
    told = []
    for r in readings:
        record, found = r.without_strongest()
        if found:
            means = ", ".join(f"{mean(some(found, n)):.2f}" for n in ("1", *FEW))
            told.append(f"without {record} {means} %")
    return f"Where columns yield far, a small difference grows in any mesh. Mean errors: {listed(told)}."


def first_floor(cells: Cells) -> str:
    told = []
    for name in dict.fromkeys(record.name for _, record in cells):
        met = [benchmark_of(g).closures[0] > 0 for (_, record), g in cells.items() if record.name == name]
        told.append(f"{name} in {sum(met)} of {len(met)}")
    return (
        "Loma Prieta closes the gap at floor 1 more often than El Centro. Of all structures under all "
        f"records of an earthquake floor 1 collides: {', '.join(told)}."
    )


def yielding(cells: Cells) -> str:
    def spread(name: str, strength: float) -> str:
        found = [
            ductility(benchmark_of(group), strength)
            for (structure, record), group in cells.items()
            if record.name == name and structure.strength == strength
        ]
        return f"{min(found):.2f} to {max(found):.2f}" if found else "-"

    return (
        "The storey yield decides. With that of Table IV El Centro reaches "
        f"{spread('El Centro', 1.0)} times the yield drift, which is not little; with twice that, Mexico "
        f"City {spread('Mexico City', 2.0)} times, which is not moderate, whatever window was tried."
    )


def equation_11(readings: Sequence[Reading]) -> str:
    found = [r.predictions(BENCHMARK) for r in readings]
    stored = [", ".join(sizes(r.predictions(BENCHMARK, of=of)) for of in STORED) + " %" for r in readings]
    return (
        "The peak of an undamped mesh with this k_C overshoots the force of bars by 14 %, which makes Eq. "
        "11 12 % low; damping of the floors takes some of it away, and touches that the motion prolongs "
        f"add to it. Signed mean errors: {listed(signed(x) + ' %' for x in found)}; errors range over "
        f"{listed(spread(x) for x in found)}. Mean sizes with the largest force stored every "
        f"{', '.join(STORED)}: {listed(stored)}."
    )


def spread(found: Sequence[Prediction]) -> str:
    """Smallest and largest error with its sign [%]."""
    errors = [p.error for p in found]
    return f"{min(errors):+.0f} to {max(errors):+.0f} %" if errors else "-"


def weak_hits(readings: Sequence[Reading]) -> str:
    told, fails = [], 0
    for r in readings:
        weak = [h for h in r.hits if h.peak <= 1000]
        whole = [abs(PAIR.force * h.approach / h.peak - 1) for h in weak if h.lasts >= GRAZE]
        strong = [abs(PAIR.force * h.approach / h.peak - 1) for h in r.hits if h.peak > 1000]
        if whole and strong:
            fails += fmean(whole) <= fmean(strong)
            errors = f"{100 * fmean(whole):.1f} and {100 * fmean(strong):.1f} %"
            told.append(f"{len(weak) - len(whole)} of {len(weak)}, {errors}")
        else:
            told.append("-")
    return (
        "It rests on grazes: touches shorter than half of T1, in which no plateau builds up. Without them "
        f"it holds in none of {fails} readings. Grazes among the touches below 1000 kN, and mean errors of "
        f"the others and of touches above 1000 kN: {listed(told)}."
        if fails == len(readings)
        else "Grazes, touches shorter than half of T1, have errors of their own. Grazes among the touches "
        "below 1000 kN, and mean errors of the others and of touches above 1000 kN: "
        f"{listed(told)}."
    )


def first_floor_hits(readings: Sequence[Reading]) -> str:
    counts = []
    for r in readings:
        hits = benchmark_of(r.groups["El Centro"]).hits
        counts.append(f"{sum(h.floor == 1 for h in hits)} and {sum(h.floor == 2 for h in hits)}")
    return (
        f"Floors 1 and 2 touch under El Centro: {listed(counts)} times. So few touches of floor 1 cannot "
        "decide it."
    )


def alike(readings: Sequence[Reading]) -> str:
    counts, ranges = [], []
    for r in readings:
        counts.append(
            ", ".join(str(sum(h.peak > 1000 for h in benchmark_of(g).hits)) for g in r.groups.values())
        )
        ranges.append(spread(r.predictions(BENCHMARK)))
    return (
        "The means are those of few collisions, and in the literal reading of errors that differ "
        "widely. Collisions above 1000 kN under "
        f"{', '.join(readings[0].groups)}: {listed(counts)}; their errors: {listed(ranges)}."
    )


def complexity(readings: Sequence[Reading]) -> str:
    names = ("1", *FEW, BENCHMARK)
    told = [
        ", ".join(signed(r.predictions(n, records=["El Centro"])) for n in names) + " %" for r in readings
    ]
    return (
        "The force is that of test 20 in all tests, and only the approach speed is taken from each test. "
        "More elements therefore cannot remove the difference of the peak from Eq. 11; missed collisions "
        f"count as -100 %. Signed mean errors with {', '.join(names)} elements: {listed(told)}."
    )


def all_tests(readings: Sequence[Reading]) -> str:
    names = ("0(equiv)", "1", *FEW, BENCHMARK)
    told = []
    for r in readings:
        group = r.groups["El Centro"]
        hits = [h for h in benchmark_of(group).hits if h.peak > 1000]
        found = [(h, match(h, run.hits)) for run in group if run.test in names for h in hits]
        shares = []
        for of in ("peak", *STORED):
            errors = [
                abs(PAIR.force * same.approach / force - 1)
                for h, same in found
                if same is not None and (force := h.force(of)) > 0.0
            ]
            good = sum(e <= 0.1 for e in errors)
            shares.append(f"{100 * good / len(found):.0f}" if found else "-")
        told.append(", ".join(shares) + " %")
    return (
        "As for statement 11, and a stored history has lower peaks. Within 10 % of the true peak, and of "
        f"the largest force stored every {', '.join(STORED)}, on the same collisions: {listed(told)}."
    )


def major(readings: Sequence[Reading]) -> str:
    counts = [sum(h.peak > 2000 for h in benchmark_of(r.groups["El Centro"]).hits) for r in readings]
    return f"As for statement 11. So few collisions are above 2000 kN under El Centro: {listed(counts)}."


#: reasons with numbers of the readings, and with numbers of all structures under all records
OF_READINGS: Mapping[str, Callable[[Sequence[Reading]], str]] = {
    "traditional": traditional,
    "underestimate": underestimate,
    "better": better,
    "one element": one_element,
    "one beyond": one_beyond,
    "far ends": far_ends,
    "progressive": progressive,
    "equation 11": equation_11,
    "weak hits": weak_hits,
    "first-floor hits": first_floor_hits,
    "alike": alike,
    "complexity": complexity,
    "all tests": all_tests,
    "major": major,
}
OF_CELLS: Mapping[str, Callable[[Cells], str]] = {
    "two elements": two_elements,
    "floor 1": first_floor,
    "yielding": yielding,
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
    of_cells = {key: reason(study.cells) if study.cells else "Not run." for key, reason in OF_CELLS.items()}
    return {key: reason(readings) for key, reason in OF_READINGS.items()} | of_cells


def first_force(study: Study) -> str:
    """Return the mean errors of Eq. 11 against peaks of the benchmark above 1000 kN."""
    return listed(signed(r.predictions(BENCHMARK)) + " %" for r in of_study(study))
