"""The text of the study: every number of it comes from the runs and from the closed forms."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import figures
from cases import BENCHMARK, TESTS
from errors import benchmark_of, drifts
from runs import PLACES, Run
from statements import judge, sensitivity
from tabulate import tabulate

PER_SPEED = 8129.6


def table(head: Sequence[str], rows: Iterable[Sequence[object]], form: str = "") -> str:
    """A Markdown table."""
    return tabulate(list(rows), head, tablefmt="pipe", floatfmt=form or "g", disable_numparse=not form)


def drift_table(runs: Sequence[Run]) -> str:
    """Drift errors of one record: places down, tests across."""
    bench = benchmark_of(runs)
    found = {(d.test, d.place, d.direction): d for d in drifts(runs, bench)}
    names = [t.name for t in TESTS[:-1]]
    rows = []
    for place in PLACES:
        for direction in ("left", "right"):
            exact = getattr(bench, direction)[place]
            errors = [f"{found[name, place, direction].error:+.1f}" for name in names]
            rows.append([place, direction, f"{exact:.3f}", *errors])
    return table(["place", "towards", f"test {BENCHMARK} [mm]", *(f"{n} [%]" for n in names)], rows)


def contact_table(runs: Sequence[Run]) -> str:
    """Closures and peak forces of one record, by test."""
    rows = [
        [r.test, *(str(n) for n in r.closures), *(f"{f:.1f}" for f in r.forces), f"{r.residual:.0e}"]
        for r in runs
    ]
    head = [
        "test",
        "closures, floor 1",
        "floor 2",
        "peak force [kN], floor 1",
        "floor 2",
        "energy residual",
    ]
    return table(head, rows)


def write(
    folder: Path,
    runs: Mapping[str, Sequence[Run]],
    variants: Mapping[str, Sequence[Run]],
    left_out: Sequence[str],
) -> None:
    """Write ``study.md`` and its pictures."""
    text = ["# The study of Cole et al. (2011), run anew", ""]
    if left_out:
        text += ["Left out, for their records are missing: " + "; ".join(left_out) + ".", ""]
    text += ["## The paper's statements", ""]
    rows = [[v.statement, v.verdict, v.figures] for v in judge(runs, PER_SPEED)]
    text += [table(["statement", "verdict", "figures"], rows), ""]
    for building in (1, 2):
        picture = folder / f"figure_{10 + building}.svg"
        figures.drift_errors(runs, building, picture)
        text += [f"![Drift errors of building {building}]({picture.name})", ""]
    for of in ("peak", "plateau"):
        for number, draw, group in (
            (13, figures.figure_13, runs),
            (14, figures.figure_14, runs["El Centro"]),
        ):
            picture = folder / f"figure_{number}_{of}.svg"
            draw(group, PER_SPEED, of, picture)
            text += [f"![Eq. 11 against the recorded {of}]({picture.name})", ""]
    for record, group in runs.items():
        text += [f"## {record}", "", contact_table(group), "", drift_table(group), ""]
    if variants:
        head = [
            "variant", "closures, floor 1", "floor 2", "peak force [kN], floor 1", "floor 2",
            "smallest traditional error [%]", "mean traditional [%]", "mean 0(equiv) [%]", "mean n = 1 [%]",
            "largest n = 2 to 5 [%]",
        ]  # fmt: skip
        rows = [sensitivity(name, group, PER_SPEED) for name, group in variants.items()]
        text += ["## What the paper does not say", "", table(head, rows), ""]
    (folder / "study.md").write_text("\n".join(text), encoding="utf-8", newline="\n")
