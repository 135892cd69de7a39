"""The paper's statements, one by one, against the runs of a reading.

Every statement is judged as it is written, and where its words allow it in a lenient form as well.  The
thresholds of both stand in `FORMS`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import fmean

from cases import BENCHMARK, PAIR, TRADITIONAL
from errors import YIELD, Drift, Prediction, benchmark_of, by_test, drifts, predictions, worst
from runs import Run

FEW = ("2", "3", "4", "5")  #: two or more elements, fewer than the benchmark
PLACES = tuple((building, storey) for building in ("B1", "B2") for storey in ("storey 1", "storey 2"))


@dataclass(frozen=True)
class Form:
    """A statement of the paper: its words in short, where they stand, and what is asked in either form."""

    statement: str
    page: int
    strict: str
    lenient: str = ""


FORMS = {
    "traditional": Form(
        "All traditional lumped models have at least 10 % error, regardless of the location of the "
        "drift", 653,
        "every error is 10 % or more",
        "each model has such an error in each storey of each building, under some record",
    ),
    "underestimate": Form(
        "The lumped masses frequently underestimate the response", 653,
        "a third of the errors are -0.1 % or less", "a quarter",
    ),
    "better": Form(
        "0(equiv) provides a significant increase in accuracy over the traditional models", 653,
        "its mean error is less than half that of each traditional model",
        "less than that of each traditional model",
    ),
    "one element": Form(
        "0(equiv) is approximately as accurate as one element per diaphragm", 653,
        "its mean error is at most 1.25 times that of one element", "at most 1.5 times",
    ),
    "one beyond": Form(
        "Drift error of 0(equiv) exceeds 10 % for one excitation in the second storey of building 2", 653,
        "there, under one record, and nowhere else", "nowhere else",
    ),
    "far ends": Form(
        "0(equiv) cannot as accurately represent the opposite ends of the buildings", 653,
        "its mean error is larger at the far ends than at the interface",
    ),
    "two elements": Form(
        "With two or more elements all errors are less than 5 %", 653,
        "every error is", "every error is, relative to no less than half the yield drift",
    ),
    "progressive": Form(
        "More elements progressively increase the accuracy", 653,
        "the mean error falls with every step of the number of elements, by 1 % of itself at least",
        "it falls so with all steps but one",
    ),
    "floor 1": Form(
        "El Centro was the only excitation to demonstrate collision at the first floor", 653,
        "floor 1 collides under El Centro and under no other record",
    ),
    "yielding": Form(
        "El Centro induces little, Mexico City moderate, Loma Prieta significant inelastic "
        "deformation", 652,
        "ductilities rise in this order, each to 1.2 times the one before at least; that of El Centro is "
        "at most 1.5, that of Mexico City above 1.2, that of Loma Prieta above 2",
        "ductilities rise in this order",
    ),
    "equation 11": Form(
        "Eq. 11 is very accurate when using the 20 element model (Figure 13)", 653,
        "within 10 % of every recorded peak above 1000 kN", "within 15 %",
    ),
    "weak hits": Form(
        "The accuracy of Eq. 11 drops at lower force magnitudes (Figure 13)", 653,
        "the mean error is larger below 1000 kN than above",
    ),
    "first-floor hits": Form(
        "First-floor collisions are not as accurately predicted by Eq. 11 (Figure 13)", 653,
        "the mean error under El Centro is larger at floor 1 than at floor 2",
    ),
    "alike": Form(
        "All three excitations present similar collision force accuracy (Figure 13)", 653,
        "the mean errors above 1000 kN of any two records differ by a factor of two at most",
        "by a factor of three",
    ),
    "complexity": Form(
        "The accuracy of Eq. 11 increases with increasing model complexity (Figure 14, El Centro)", 653,
        "its mean error above 1000 kN falls with every step of the number of elements up to 20, by 1 % of "
        "itself at least",
        "it falls so with all steps but one",
    ),
    "all tests": Form(
        "Without the traditional models all results above 1000 kN are within 15 %, and all except two "
        "within 10 % (Figure 14, El Centro)", 653,
        "both", "within 15 %",
    ),
    "major": Form(
        "The force is accurately calculated for major collisions (above 2000 kN) in all tests (Figure "
        "14)", 653,
        "within 15 % of every recorded peak above 2000 kN, traditional models too",
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Verdict:
    """What the runs say of a statement; None where they have nothing to judge it by.

    Attributes
    ----------
    strict, lenient : bool or None
        Whether it holds as written, and in its lenient form.  One form: the same twice.
    figures, rests : str
        Numbers, and on how many errors, collisions or records they rest.
    """

    strict: bool | None
    lenient: bool | None
    figures: str
    rests: str = ""

    @property
    def word(self) -> str:
        """Verdict in words."""
        if self.strict is None:
            return "nothing to judge"
        return "holds" if self.strict else "holds leniently" if self.lenient else "does not hold"


Runs = Mapping[str, Sequence[Run]]


def judge(runs: Runs, strength: float = 1.0) -> dict[str, Verdict]:
    """All statements, by their keys in `FORMS`.

    Parameters
    ----------
    runs : mapping
        Runs of every record by its name.
    strength : float
        Storey yield of the reading over that of Table IV.
    """
    return {**of_drifts(runs, strength), **forces(runs)}


def of_drifts(runs: Runs, strength: float) -> dict[str, Verdict]:
    """Statements on drifts, yielding and first-floor contact."""
    found = [d for group in runs.values() for d in drifts(group, benchmark_of(group), strength)]
    return {
        "traditional": traditional(found),
        "underestimate": underestimate(found),
        "better": better(found),
        "one element": like_one_element(found),
        "one beyond": only_one_beyond(found),
        "far ends": far_ends(found),
        "two elements": two_elements(found),
        "progressive": progressive(found),
        "floor 1": first_floor(runs),
        "yielding": yielding(runs, strength),
    }


def some(found: Sequence[Drift], *tests: str) -> list[Drift]:
    """The errors of some tests."""
    return [d for d in found if d.test in tests]


def mean(found: Sequence[Drift]) -> float:
    """Mean size of errors [%]."""
    return fmean(abs(d.error) for d in found)


def traditional(found: Sequence[Drift]) -> Verdict:
    errors = some(found, *TRADITIONAL)
    large = [d for d in errors if abs(d.error) >= 10]
    small = min(abs(d.error) for d in errors)
    seen = {(d.test, d.place[:2], d.place[3:11]) for d in large}
    wanted = len(TRADITIONAL) * len(PLACES)
    return Verdict(
        len(large) == len(errors),
        len(seen) == wanted,
        f"{len(large)} of {len(errors)} errors are 10 % or more, the smallest is {small:.1f} %; "
        f"{len(seen)} of {wanted} models and storeys have one",
        f"{len(errors)} errors",
    )


def underestimate(found: Sequence[Drift]) -> Verdict:
    errors = some(found, *TRADITIONAL)
    low = [d for d in errors if d.error <= -0.1]
    nearly = sum(-0.1 < d.error < 0 for d in errors)
    return Verdict(
        3 * len(low) >= len(errors),
        4 * len(low) >= len(errors),
        f"{len(low)} of {len(errors)} errors are -0.1 % or less; {nearly} more are negative, by "
        "rounding or nearly so",
        f"{len(errors)} errors",
    )


def better(found: Sequence[Drift]) -> Verdict:
    equiv = mean(some(found, "0(equiv)"))
    old = [mean(some(found, name)) for name in TRADITIONAL]
    figures = f"mean errors {equiv:.2f} %, and " + ", ".join(f"{m:.2f}" for m in old) + " %"
    return Verdict(2 * equiv < min(old), equiv < min(old), figures, "4 means")


def like_one_element(found: Sequence[Drift]) -> Verdict:
    equiv, one = mean(some(found, "0(equiv)")), mean(some(found, "1"))
    figures = f"mean errors {equiv:.2f} % and {one:.2f} %"
    return Verdict(equiv <= 1.25 * one, equiv <= 1.5 * one, figures, "2 means")


def only_one_beyond(found: Sequence[Drift]) -> Verdict:
    where = {(d.record, d.place[:11]) for d in some(found, "0(equiv)") if abs(d.error) > 10}
    there = all(place == "B2 storey 2" for _, place in where)
    names = ", ".join(sorted(f"{place} ({record})" for record, place in where)) or "none"
    rests = f"{len(some(found, '0(equiv)'))} errors"
    return Verdict(there and len(where) == 1, there and len(where) <= 1, f"above 10 %: {names}", rests)


def far_ends(found: Sequence[Drift]) -> Verdict:
    far, near = [], []
    for d in some(found, "0(equiv)"):
        (far if d.far else near).append(d)
    holds = mean(far) > mean(near)
    figures = f"mean errors {mean(far):.2f} % at the far ends, {mean(near):.2f} % at the interface"
    return Verdict(holds, holds, figures, "2 means")


def two_elements(found: Sequence[Drift]) -> Verdict:
    errors = some(found, *FEW)
    small = sum(abs(d.error) < 5 for d in errors)
    scaled = max(abs(d.scaled) for d in errors)
    return Verdict(
        small == len(errors),
        scaled < 5,
        f"{small} of {len(errors)} errors are below 5 %, the largest is {worst(errors):.1f} %; relative "
        f"to no less than half the yield drift it is {scaled:.1f} %",
        f"{len(errors)} errors",
    )


def progressive(found: Sequence[Drift]) -> Verdict:
    tests = [n for n in ("1", *FEW) if some(found, n)]
    means = [mean(some(found, n)) for n in tests]
    rises = sum(0.99 * a < b for a, b in pairwise(means))
    return Verdict(
        rises == 0,
        rises <= 1,
        f"mean errors with {', '.join(tests)} elements: " + ", ".join(f"{m:.2f}" for m in means) + " %",
        f"{len(means)} means",
    )


def first_floor(runs: Runs) -> Verdict:
    met = {record: bool(benchmark_of(group).closures[0]) for record, group in runs.items()}
    holds = met == {record: record == "El Centro" for record in runs}
    names = [record for record, yes in met.items() if yes]
    touches = sum(benchmark_of(group).closures[0] for group in runs.values())
    figures = f"floor 1 collides in {', '.join(names) or 'none'}"
    return Verdict(holds, holds, figures, f"{touches} {'touch' if touches == 1 else 'touches'}")


def yielding(runs: Runs, strength: float) -> Verdict:
    reached = {}
    for record, group in runs.items():
        run = benchmark_of(group)
        reached[record] = max(
            value / (strength * YIELD[place[:2]])
            for drift in (run.right, run.left)
            for place, value in drift.items()
        )
    ordered = [reached[r] for r in ("El Centro", "Mexico City", "Loma Prieta") if r in reached]
    rising = all(a < b for a, b in pairwise(ordered))
    apart = len(ordered) == 3 and all(1.2 * a <= b for a, b in pairwise(ordered))
    return Verdict(
        apart and ordered[0] <= 1.5 and ordered[1] > 1.2 and ordered[2] > 2,
        rising,
        "largest drift over yield drift: " + ", ".join(f"{r} {x:.2f}" for r, x in reached.items()),
        f"{len(ordered)} drifts",
    )


def forces(runs: Runs, of: str = "peak") -> dict[str, Verdict]:
    """Statements on Eq. 11; `of` is what is taken for the recorded force, as `Hit.force` has it."""
    of_bench = {
        record: list(predictions(benchmark_of(group), benchmark_of(group), PAIR.force, of))
        for record, group in runs.items()
    }
    together = [p for found in of_bench.values() for p in found]
    group = runs["El Centro"]
    every = [p for run in group for p in predictions(run, benchmark_of(group), PAIR.force, of)]
    strong = [p for p in together if p.force > 1000]
    weak = [p for p in together if p.force <= 1000]
    first, second = ([p for p in of_bench["El Centro"] if p.floor == n] for n in (1, 2))
    rest = [p for p in every if p.force > 1000 and p.test not in TRADITIONAL and p.test != "0(exact)"]
    major = [p for p in every if p.force > 2000 and p.test != "0(exact)"]
    return {
        "equation 11": within(strong, 10),
        "weak hits": worse(weak, strong, "below 1000 kN", "above"),
        "first-floor hits": worse(first, second, "at floor 1", "at floor 2"),
        "alike": alike({r: [p for p in found if p.force > 1000] for r, found in of_bench.items()}),
        "complexity": more_complex([p for p in every if p.force > 1000]),
        "all tests": within(rest, 15, beyond10=2),
        "major": within(major, 15),
    }


def alike(strong: Mapping[str, Sequence[Prediction]]) -> Verdict:
    """Whether the mean errors of the records are alike, where two or more have such collisions."""
    means = {record: fmean(errors_of(found)) for record, found in strong.items() if found}
    if len(means) < 2:
        return Verdict(None, None, "fewer than two records have such collisions")
    ratio = max(means.values()) / min(means.values())
    figures = ", ".join(f"{record} {m:.1f} %" for record, m in means.items())
    rests = ", ".join(str(len(found)) for found in strong.values()) + " collisions"
    return Verdict(ratio <= 2, ratio <= 3, f"mean errors: {figures}", rests)


def more_complex(strong: Sequence[Prediction]) -> Verdict:
    """Whether the mean error falls with the number of elements."""
    names = [n for n in ("1", *FEW, BENCHMARK) if any(p.test == n for p in strong)]
    if not names:
        return Verdict(None, None, "no such collision")
    means = [fmean(errors_of([p for p in strong if p.test == n])) for n in names]
    rises = sum(0.99 * a < b for a, b in pairwise(means))
    listed = ", ".join(f"{m:.1f}" for m in means)
    figures = f"mean errors with {', '.join(names)} elements: {listed} %"
    return Verdict(rises == 0, rises <= 1, figures, of_collisions(strong))


def errors_of(found: Sequence[Prediction]) -> list[float]:
    """Sizes of errors [%]."""
    return [abs(p.error) for p in found]


def of_collisions(found: Sequence[Prediction]) -> str:
    """Number of collisions that some predictions, of several tests, are of."""
    count = len({(p.record, p.floor, p.t) for p in found})
    return f"{count} collision{'s' * (count != 1)}"


def within(found: Sequence[Prediction], limit: float, beyond10: int | None = None) -> Verdict:
    """Whether all errors are within the limit [%], and all but `beyond10` within 10 %; leniently, within
    15 %.
    """
    if not found:
        return Verdict(None, None, "no such collision")
    errors = errors_of(found)
    good, far = sum(e <= 15 for e in errors), sum(e > 10 for e in errors)
    strict = max(errors) <= limit and (beyond10 is None or far <= beyond10)
    figures = f"{good} of {len(errors)} within 15 %, {far} beyond 10 %, mean {fmean(errors):.1f} %"
    return Verdict(strict, good == len(errors), figures, of_collisions(found))


def worse(ones: Sequence[Prediction], others: Sequence[Prediction], where: str, elsewhere: str) -> Verdict:
    """Whether the mean error of some collisions is larger than that of others."""
    if not ones or not others:
        return Verdict(None, None, f"no collision {elsewhere if ones else where}")
    one, other = fmean(errors_of(ones)), fmean(errors_of(others))
    figures = f"mean error {one:.1f} % {where} ({len(ones)}), {other:.1f} % {elsewhere} ({len(others)})"
    return Verdict(one > other, one > other, figures, f"{len(ones)} and {len(others)} collisions")


def sensitivity(variant: str, runs: Sequence[Run]) -> list[object]:
    """One row of the sensitivity table: the main figures of a variant."""
    found = list(drifts(runs, benchmark_of(runs)))
    tests = by_test(runs)
    bench = tests[BENCHMARK]
    old = some(found, "0(10)")
    return [
        variant,
        *(f"{n}" for n in bench.closures),
        *(f"{f:.0f}" for f in bench.forces),
        f"{min(abs(d.error) for d in old):.1f}",
        *(f"{mean(group):.1f}" for group in (old, some(found, "0(equiv)"), some(found, "1"))),
        f"{worst(some(found, '2')):.1f}",
    ]
