"""The text of the study: every number of it comes from the runs and from the closed forms."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from pathlib import Path
from statistics import fmean

import figures
from cases import BENCHMARK, EXACT_EQUIVALENT, PAIR, TESTS
from errors import benchmark_of, by_test, drifts, worst
from runs import PLACES, Run
from statements import judge, sensitivity
from tabulate import tabulate

from pound_solve.report.plot import style


@dataclass(frozen=True)
class Study:
    """All runs.

    Attributes
    ----------
    records : mapping
        The ten tests and the exact equivalent contact of every record.
    variants : mapping
        Tests of every assumption that the paper leaves open.
    systems, finer : sequence of Run
        Named systems; more elements than the benchmark.
    left_out : sequence of str
        Cases without a record.
    """

    records: Mapping[str, Sequence[Run]]
    variants: Mapping[str, Sequence[Run]]
    systems: Sequence[Run]
    finer: Sequence[Run]
    left_out: Sequence[str]

    @property
    def paper(self) -> dict[str, list[Run]]:
        """The paper's own tests of every record."""
        own = {t.name for t in TESTS}
        return {name: [r for r in group if r.test in own] for name, group in self.records.items()}


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A Markdown table of formatted cells."""
    return tabulate(list(rows), head, tablefmt="pipe", disable_numparse=True)


def table_iv() -> str:
    """What follows from Table IV in closed form, beside the paper's figures."""
    first, second = PAIR.first, PAIR.second
    rows = [
        ["collision period T1, T2 [s]", "0.019, 0.04", f"{first.period:.6f}, {second.period:.6f}"],
        ["impedance Z1, Z2 [kN s/m]", "", f"{first.impedance:.0f}, {second.impedance:.0f}"],
        ["alpha 1, 2 lumped", "0.652, 0.348", "{:.3f}, {:.3f}".format(*PAIR.alpha_lumped)],
        ["alpha 1, 2 distributed, Table III", "0.464, 0.248", "{:.3f}, {:.3f}".format(*PAIR.alpha_paper)],
        ["alpha 1, 2 distributed, exact", "", "{:.3f}, {:.3f}".format(*PAIR.alpha)],
        ["e_eff by Eq. 14", "", f"{PAIR.e_paper:.5f}"],
        ["e_eff exact", "", f"{PAIR.e:.5f}"],
        ["duration exact [s]", "", f"{PAIR.duration:.6f}"],
        ["force at 1 m/s, Eq. 11 [kN]", "", f"{PAIR.force:.1f}"],
    ]
    return table(["quantity", "paper, Table IV", "here"], rows)


def drift_table(runs: Sequence[Run]) -> str:
    """Drift errors of one record: places down, tests across."""
    bench = benchmark_of(runs)
    names = [r.test for r in runs if r is not bench]
    found = {(d.test, d.place, d.direction): d for d in drifts(runs, bench)}
    rows = []
    for place in PLACES:
        for direction in ("left", "right"):
            errors = [f"{found[name, place, direction].error:+.1f}" for name in names]
            rows.append([place, direction, f"{getattr(bench, direction)[place]:.3f}", *errors])
    return table(["place", "direction", f"test {BENCHMARK} [mm]", *(f"{n} [%]" for n in names)], rows)


def contact_rows(runs: Sequence[Run]) -> list[list[str]]:
    """Closures and peak forces of some runs."""
    return [
        [
            r.test,
            *map(str, r.closures),
            *("-" if isnan(f) else f"{f:.1f}" for f in r.forces),
            f"{r.residual:.0e}",
        ]
        for r in runs
    ]


CONTACT_HEAD = (
    "test", "closures, floor 1", "floor 2", "peak force [kN], floor 1", "floor 2", "energy residual",
)  # fmt: skip


def systems_table(runs: Sequence[Run], benchmark: Run) -> str:
    """Answers of the named systems for the paper's buildings, El Centro."""
    rows = []
    for run, row in zip(runs, contact_rows(runs)):
        found = list(drifts([run], benchmark))
        mean = fmean(abs(d.error) for d in found)
        rows.append([*row[:5], f"{mean:.1f}", f"{worst(found):.1f}", row[5]])
    head = [*CONTACT_HEAD[:5], "mean drift error [%]", "largest [%]", CONTACT_HEAD[5]]
    return table(["system", *head[1:]], rows)


def finer_table(runs: Sequence[Run], benchmark: Run) -> str:
    """More elements than the benchmark: how far the benchmark itself is from them."""
    finest = runs[-1]
    rows = []
    for run, row in zip([benchmark, *runs], contact_rows([benchmark, *runs])):
        found = list(drifts([run], finest))
        rows.append([*row[:5], f"{fmean(abs(d.error) for d in found):.2f}", f"{worst(found):.2f}"])
    head = [*CONTACT_HEAD[:5], f"mean drift difference from n = {finest.test} [%]", "largest [%]"]
    return table(head, rows)


def equivalent_table(study: Study) -> str:
    """The paper's equivalent contact, the exact one, and one element, by record."""
    rows = []
    for record, group in study.records.items():
        for name in ("0(equiv)", EXACT_EQUIVALENT.name, "1"):
            run = by_test(group)[name]
            found = list(drifts([run], benchmark_of(group)))
            forces = (f"{f:.0f}" for f in run.forces)
            rows.append(
                [record, name, f"{fmean(abs(d.error) for d in found):.1f}", f"{worst(found):.1f}", *forces]
            )
    head = ["record", "test", "mean drift error [%]", "largest [%]", "peak force [kN], floor 1", "floor 2"]
    return table(head, rows)


def pictures(folder: Path, study: Study) -> dict[str, Path]:
    """Draw all pictures; the file of each by its subject."""
    paper, speed = study.paper, PAIR.force
    drawn = {
        "figure 6": (figures.figure_6,),
        "figure 7": (figures.figure_7,),
        "theory": (figures.theory_map,),
        "figure 11": (figures.drift_errors, paper, 1),
        "figure 12": (figures.drift_errors, paper, 2),
    }
    for of in ("peak", "plateau"):
        drawn[f"figure 13 {of}"] = (figures.figure_13, paper, speed, of)
        drawn[f"figure 14 {of}"] = (figures.figure_14, paper["El Centro"], speed, of)
    out: dict[str, Path] = {}
    for name, (draw, *what) in drawn.items():
        out[name] = folder / f"{name.replace(' ', '_')}.svg"
        with style.sheet():
            draw(*what, out[name])
    return out


def write(page: Path, folder: Path, study: Study) -> None:
    """Write the text into `page`, and its pictures into a folder beside or below it."""
    files = pictures(folder, study)
    paper, bench = study.paper, benchmark_of(study.paper["El Centro"])

    def shown(name: str, text: str) -> str:
        return f"![{text}]({files[name].relative_to(page.parent).as_posix()})"

    verdicts = [[v.statement, v.verdict, v.figures] for v in judge(paper, PAIR.force)]
    parts = [
        "# The study of Cole et al. (2011), repeated",
        "Generated by `python examples/cole2011/study`; every number comes from its runs or from the "
        "closed forms of `pound_solve.theory.two_bars`. The assumptions are listed with the decks, in "
        "`examples/cole2011/README.md`.",
    ]
    if study.left_out:
        parts.append("Omitted because their records are missing: " + "; ".join(study.left_out) + ".")
    parts += [
        "## The theory",
        table_iv(),
        shown("figure 6", "Influence coefficients (Figure 6)"),
        shown("figure 7", "Effective restitution (Figure 7)"),
        shown("theory", "Error of Eq. 14"),
        "## The paper's statements",
        table(["statement", "verdict", "figures"], verdicts),
        "## Drift errors (Figures 11 and 12)",
        shown("figure 11", "Drift errors of building 1 (Figure 11)"),
        shown("figure 12", "Drift errors of building 2 (Figure 12)"),
        "## Eq. 11 against recorded forces (Figures 13 and 14)",
        "The recorded force is read in two ways: as the peak, which on a mesh of lumped masses oscillates "
        "about a plateau, and as the plateau: the impulse over the duration of the collision.",
        *(shown(f"figure {n} {of}", f"Figure {n}, {of}") for n in (13, 14) for of in ("peak", "plateau")),
    ]
    for record, group in paper.items():
        parts += [f"## {record}", table(CONTACT_HEAD, contact_rows(group)), drift_table(group)]
    parts += ["## Equivalent contact by the exact theory", equivalent_table(study)]
    if study.systems:
        parts += [
            "## All systems named in the paper, El Centro",
            systems_table(study.systems, bench),
            "Drift errors are relative to distributed masses. Laws with a restitution have E = 0.65 (the "
            "multiplier 0; 1 where marked elastic) and the stiffness of the stiffer diaphragm; the Hertz "
            "laws have the stiffness that gives the same elastic force at 0.3 m/s. Rigid contacts have "
            "impulses instead of peak forces.",
        ]
    if study.finer:
        parts += ["## More elements", finer_table(study.finer, bench)]
    if study.variants:
        head = [
            "variant", "closures, floor 1", "floor 2", "peak force [kN], floor 1", "floor 2",
            "smallest traditional error [%]", "mean traditional [%]", "mean 0(equiv) [%]", "mean n = 1 [%]",
            "largest n = 2 to 5 [%]",
        ]  # fmt: skip
        groups = {"decks unchanged": paper["El Centro"], **study.variants}
        rows = [sensitivity(name, group) for name, group in groups.items()]
        parts += ["## What the paper leaves open", table(head, rows)]
    page.write_text("\n\n".join(parts) + "\n", encoding="utf-8", newline="\n")
