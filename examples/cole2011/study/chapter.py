"""The text of the study: every number of it comes from the runs and from the closed forms."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from math import isnan
from pathlib import Path
from statistics import fmean

import figures
from cases import BENCHMARK, CANDIDATES, EXACT_EQUIVALENT, PAIR
from choices import READINGS
from errors import benchmark_of, by_test, drifts, worst
from gathered import Group, Study
from practice import Cell, beats, practice
from runs import PLACES, Run
from statements import FORMS, forces, judge, mean, sensitivity, some
from tabulate import tabulate

from pound_solve.report.plot import style

STRENGTH = {reading.name: float(str(reading.params.get("fy1", 2400))) / 2400 for reading in READINGS}


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A Markdown table of formatted cells."""
    return tabulate(list(rows), head, tablefmt="pipe", disable_numparse=True)


def table_iv() -> str:
    """What follows from Table IV in closed form, beside the paper's figures."""
    first, second = PAIR.first, PAIR.second
    rows = [
        ["collision period T1, T2, Eq. 5 [s]", "0.019, 0.04", f"{first.period:.6f}, {second.period:.6f}"],
        ["impedance Z1, Z2 [kN s/m]", "", f"{first.impedance:.0f}, {second.impedance:.0f}"],
        ["alpha 1, 2 lumped, Table III", "0.652, 0.348", "{:.3f}, {:.3f}".format(*PAIR.alpha_lumped)],
        ["alpha 1, 2 distributed, Table III", "0.464, 0.248", "{:.3f}, {:.3f}".format(*PAIR.alpha_paper)],
        ["alpha 1, 2 distributed, exact", "", "{:.3f}, {:.3f}".format(*PAIR.alpha)],
        ["e_eff by Eq. 14", "", f"{PAIR.e_paper:.5f}"],
        ["e_eff exact, for Eq. 13", "", f"{PAIR.e:.5f}"],
        ["duration by the paper, exact [s]", "T1", f"{PAIR.duration:.6f}"],
        ["twice the centroid of the force [s]", "", f"{2 * PAIR.centroid:.6f}"],
        ["force at 1 m/s, Eq. 11 [kN]", "", f"{PAIR.force:.1f}"],
    ]
    return table(["quantity", "paper, Table IV", "here"], rows)


def readings_table(name: str) -> str:
    """Choices of a reading and their grounds."""
    grounds = next(r.grounds for r in READINGS if r.name == name)
    return table(["item", "choice", "ground"], grounds)


def statements_table(study: Study) -> str:
    """Verdict and figures of every statement, a reading beside the other."""
    judged = {name: judge(study.paper(name), STRENGTH[name]) for name in study.readings}
    rows = []
    for key, form in FORMS.items():
        row = [form.statement, str(form.page)]
        for verdicts in judged.values():
            row += [verdicts[key].word, verdicts[key].figures]
        rows.append(row)
    counts = {name: sum(v.strict is True for v in verdicts.values()) for name, verdicts in judged.items()}
    told = ", ".join(f"{count} of {len(FORMS)} under the {name} reading" for name, count in counts.items())
    head = ["statement", "page", *(cell for name in judged for cell in (f"{name} reading", "figures"))]
    return table(head, rows) + f"\n\nHold as written: {told}."


def plateau_table(study: Study) -> str:
    """Statements on Eq. 11 with the plateau as the recorded force."""
    judged = {name: forces(study.paper(name), "plateau") for name in study.readings}
    rows = [
        [FORMS[key].statement, *(cell for v in judged.values() for cell in (v[key].word, v[key].figures))]
        for key in next(iter(judged.values()))
    ]
    return table(["statement", *(c for name in judged for c in (f"{name} reading", "figures"))], rows)


def drift_table(runs: Sequence[Run], strength: float) -> str:
    """Drift errors of one record: places down, tests across."""
    bench = benchmark_of(runs)
    names = [r.test for r in runs if r is not bench]
    found = {(d.test, d.place, d.direction): d for d in drifts(runs, bench, strength)}
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
        rows.append([*row[:5], f"{mean(found):.1f}", f"{worst(found):.1f}", row[5]])
    head = [*CONTACT_HEAD[:5], "mean drift error [%]", "largest [%]", CONTACT_HEAD[5]]
    return table(["system", *head[1:]], rows)


def finer_table(runs: Sequence[Run], lumped: Sequence[Run]) -> str:
    """Equivalent contacts, few elements and the benchmark against the finest mesh."""
    finest = runs[-1]
    rows = []
    every = [*lumped, *runs]
    for run, row in zip(every, contact_rows(every)):
        found = list(drifts([run], finest))
        rows.append([*row[:5], f"{mean(found):.2f}", f"{worst(found):.2f}"])
    head = [*CONTACT_HEAD[:5], f"mean drift difference from n = {finest.test} [%]", "largest [%]"]
    return table(head, rows)


def benchmark_told(finer: Sequence[Run], bench: Run) -> str:
    """What the benchmark itself leaves open."""
    finest = finer[-1]
    found = list(drifts([bench], finest))
    forces = " and ".join(f"{100 * (a / b - 1):+.1f} %" for a, b in zip(bench.forces, finest.forces))
    return (
        f"The benchmark of {BENCHMARK} elements is itself {mean(found):.2f} % off {finest.test} elements "
        f"in the mean of the drifts, {worst(found):.2f} % at most, and {forces} in the peak forces of the "
        "floors. Errors against it do not resolve smaller differences between models. This was found for "
        "one record and one reading."
    )


def equivalent_table(study: Study) -> str:
    """Equivalent contacts beside few elements, against the benchmark, by reading and record."""
    names = ("0(equiv)", *(t.name for t in CANDIDATES), EXACT_EQUIVALENT.name, "1", "2", "5")
    rows = []
    for reading, groups in study.readings.items():
        for record, group in groups.items():
            bench = benchmark_of(group)
            for name in names:
                run = by_test(group)[name]
                found = list(drifts([run], bench, STRENGTH[reading]))
                peaks = [f"{f:.0f}" for f in (*run.forces, *bench.forces)]
                errors = [
                    f"{x:.2f}" for x in (mean(found), worst(found), fmean(abs(d.scaled) for d in found))
                ]
                rows.append(
                    [reading, record, name, *errors, f"{peaks[0]} ({peaks[2]})", f"{peaks[1]} ({peaks[3]})"]
                )
    head = [
        "reading", "record", "test", "mean drift error [%]", "largest [%]", "mean, of no less than half "
        "yield [%]",
        f"peak force (that of {BENCHMARK}) [kN], floor 1", "floor 2",
    ]  # fmt: skip
    return table(head, rows)


def stiffness_table(study: Study) -> str:
    """Peak forces and drift errors of the equivalent contacts over k_D1."""
    rows = []
    for factor, group in study.stiffness.items():
        bench = by_test(group)[BENCHMARK]
        row = [f"{factor:g}"]
        for name in figures.CONTACTS:
            run = by_test(group)[name]
            row += [f"{run.forces[1]:.1f}", f"{mean(list(drifts([run], bench))):.2f}"]
        rows.append([*row, f"{bench.forces[1]:.1f}"])
    head = ["k_D1 / Table IV"]
    for name in figures.CONTACTS.values():
        head += [f"{name}: peak [kN]", "mean drift error [%]"]
    return table([*head, "test 20: peak [kN]"], rows)


def parting_table(study: Study) -> str:
    """How long strong touches last in the benchmark, in collision periods."""
    rows = []
    for reading, groups in study.readings.items():
        for record, group in groups.items():
            strong = [h for h in benchmark_of(group).hits if h.peak > 800]
            if strong:
                lasts = sorted(h.lasts / PAIR.first.period for h in strong)
                near = sum(x < 1.2 for x in lasts)
                rows.append(
                    [reading, record, str(len(strong)), str(near), ", ".join(f"{x:.2f}" for x in lasts)]
                )
    head = [
        "reading",
        "record",
        "touches above 800 kN",
        "part before 1.2 T1",
        "durations over T1 (T2 = 2.17 T1)",
    ]
    return table(head, rows)


def ranges_table(study: Study) -> str:
    """Ranges of the main figures under records disturbed a little."""
    rows = []
    for (reading, record), groups in study.disturbed.items():
        every = [study.readings[reading][record], *groups]
        columns = []
        for of in (
            lambda g: list(benchmark_of(g).forces),
            lambda g: [max(max(d.values()) for d in (benchmark_of(g).left, benchmark_of(g).right))],
            lambda g: [worst(some(list(drifts(g, benchmark_of(g))), "2"))],
            *(partial(errors_of, name=name) for name in (EXACT_EQUIVALENT.name, "2")),
        ):
            found = list(zip(*(of(g) for g in every)))
            columns += [f"{min(v):.4g} to {max(v):.4g}" for v in found]
        rows.append([reading, record, *columns])
    head = [
        "reading", "record", "peak force of test 20 [kN], floor 1", "floor 2", "its largest drift [mm]",
        "largest error, n = 2 [%]", "mean error, 0(exact) [%]", "mean error, n = 2 [%]",
    ]  # fmt: skip
    return table(head, rows)


def below_five(study: Study) -> str:
    """Whether two elements stay below 5 % under the disturbed records."""
    largest: dict[str, float] = {}
    for (reading, record), groups in study.disturbed.items():
        for g in (study.readings[reading][record], *groups):
            error = worst(some(list(drifts(g, benchmark_of(g))), "2"))
            largest[reading] = max(error, largest.get(reading, 0.0))
    told = ", ".join(f"{error:.1f} % in the {reading} reading" for reading, error in largest.items())
    return f"The largest error with two elements, under any of these records: {told}."


def errors_of(group: Group, name: str) -> list[float]:
    """Mean drift error of one test [%]."""
    return [mean(some(list(drifts(group, benchmark_of(group))), name))]


def pictures(folder: Path, study: Study) -> dict[str, Path]:
    """Draw all pictures; the file of each by its subject."""
    drawn: dict[str, partial[None]] = {
        "figures 1 to 5": partial(figures.snapshots),
        "figure 6": partial(figures.figure_6),
        "figure 7": partial(figures.figure_7),
        "theory": partial(figures.theory_map),
    }
    for name in study.readings:
        paper = study.paper(name)
        records = [r for r in study.records[name] if r.name in paper]
        drawn |= {
            f"figure 9 {name}": partial(figures.inputs, records, study.folders, 10.0),
            f"figure 11 {name}": partial(figures.drift_errors, paper, 1),
            f"figure 12 {name}": partial(figures.drift_errors, paper, 2),
            f"figure 13 {name}": partial(figures.figure_13, paper, PAIR.force, "peak"),
            f"figure 14 {name}": partial(figures.figure_14, paper["El Centro"], PAIR.force, "peak"),
        }
    if study.stiffness:
        drawn["stiffness"] = partial(figures.over_stiffness, study.stiffness)
    out: dict[str, Path] = {}
    for name, draw in drawn.items():
        out[name] = folder / f"{name.replace(' ', '_')}.svg"
        with style.sheet():
            draw(out[name])
    return out


Shown = Callable[[str, str], str]


def cells_of(study: Study) -> list[Cell]:
    """All tests of every reading under every record."""
    return [(STRENGTH[name], group) for name, groups in study.readings.items() for group in groups.values()]


def opening(study: Study, shown: Shown) -> list[str]:
    """Theory, readings and statements."""
    parts = [
        "# The study of Cole et al. (2011), repeated",
        "Generated by `python examples/cole2011/study`; every number comes from its runs or from the "
        "closed forms of "
        "`pound_solve.laws.two_bars`. The decks are in `examples/cole2011`. Pages, figures, tables "
        "and equations "
        "are those of the paper.",
    ]
    if study.left_out:
        parts.append("Left out, or done otherwise:\n\n" + "\n".join(f"- {line}" for line in study.left_out))
    return [
        *parts,
        "## The collision (Figures 1 to 5, Tables I to III, Eqs 1 to 14)",
        "Two diaphragms with the period ratio of Table I, T1 = 0.75 T2, and the impedances Z1 = 0.75 "
        "Z2, at the "
        "instants of Figure 5: velocities and compression over the length, from the method of "
        "characteristics. "
        "The lines of Table I follow from them (a test compares their momenta). The bars of Table IV have "
        "Z1 > Z2 and do not part at T1.",
        shown("figures 1 to 5", "Velocity and compression during a collision (Figure 5, Table I)"),
        table_iv(),
        shown("figure 6", "Influence coefficients (Figure 6)"),
        shown("figure 7", "Effective restitution (Figure 7)"),
        shown("theory", "Error of Eq. 14"),
        "Eq. 13 with the exact restitution, $v_1' = v_1 - (1+e)\\alpha_1(v_1-v_2)$ and $\\alpha_1$ that "
        "of lumped "
        "masses, gives the exact velocities on both sides of Z1 = Z2.",
        "That the diaphragms of Table IV do not part at T1 holds for free bars. In buildings the "
        "columns pull and the "
        "floors have accelerations; the touches of test 20 last:",
        parting_table(study),
        "## Two readings",
        "The paper gives the masses, stiffnesses and yields of Table IV, the gap, the components and "
        "factors of the "
        "records, and the tests. It does not give damping, hardening, column positions, stations, "
        "processing, signs "
        "and windows. Two sets of PARAMs of the same decks are run. The literal reading takes every "
        "number as printed "
        "and a usual value elsewhere; of the two signs of El Centro it takes the one under which floor 1 "
        "collides. The best reading was chosen, before these runs, because many of the statements below "
        "hold under it. Its verdicts show that the statements can be had together; they are no evidence "
        "for the statements, nor that the authors ran it. [The readings](cole2011-readings.md) show on how "
        "many of them each statement rests.",
        *(
            f"### The {name} reading\n\n{readings_table(name)}\n\n"
            + shown(f"figure 9 {name}", f"Scaled input (Figure 9), {name} reading")
            for name in study.readings
        ),
        "### How statements are judged",
        "A statement is judged as written, and where its words allow it in a lenient form. Words like "
        "'frequently', 'approximately', 'similar' or 'little' have no numbers in the paper: the thresholds "
        "are ours. Errors are "
        "relative to "
        f"test {BENCHMARK}, as in the paper. Numbers of closures are no criterion: only whether a floor "
        f"collides.",
        table(
            ["statement", "page", "holds", "holds leniently"],
            [[f.statement, str(f.page), f.strict, f.lenient or "-"] for f in FORMS.values()],
        ),
        "## The paper's statements",
        statements_table(study),
        "## The same statements on Eq. 11 with the plateau (ours)",
        "The peak of a mesh of lumped masses oscillates about a plateau: the impulse over the duration "
        "of the "
        "collision, but over no more than the I/F of the theory. The paper takes the recorded force, so "
        "the peak "
        "judges its statements.",
        plateau_table(study),
    ]


def evidence(study: Study, shown: Shown) -> list[str]:
    """Drifts and forces by reading and record."""
    parts = []
    for name, groups in study.readings.items():
        parts += [
            f"## Drifts and forces, {name} reading (Figures 11 to 14)",
            shown(f"figure 11 {name}", f"Drift errors of building 1 (Figure 11), {name} reading"),
            shown(f"figure 12 {name}", f"Drift errors of building 2 (Figure 12), {name} reading"),
            shown(f"figure 13 {name}", f"Eq. 11 in test 20 (Figure 13), {name} reading"),
            shown(f"figure 14 {name}", f"Eq. 11 in all tests (Figure 14), {name} reading"),
        ]
        for record in groups:
            group = study.paper(name)[record]
            parts += [
                f"### {record}, {name} reading",
                table(CONTACT_HEAD, contact_rows(group)),
                drift_table(group, STRENGTH[name]),
            ]
    if study.disturbed:
        parts += [
            "## Ranges",
            "What a record 1 % weaker or stronger, and one that begins a sample earlier or later, makes "
            "of the "
            "figures. A digit that changes within such a range says nothing about the buildings.",
            ranges_table(study),
            below_five(study),
        ]
    return parts


def contacts(study: Study, shown: Shown) -> list[str]:
    """The equivalent contact by the exact theory."""
    parts = [
        "## The equivalent contact by the exact theory",
        "`0(equiv)` is the paper's (Eqs 14 to 17). `0(exact)` has the impulse and the centroid of the "
        "bars' force "
        "([theory](theory-pounding.md#4-the-equivalent-contact)). The others have the exact restitution "
        "and another "
        "duration: `0(centroid)` twice the centroid, `0(impulse)` the impulse over the first force, "
        "`0(touch)` the "
        "time that the bars touch, which jumps from T1 to T2 at Z1 = Z2.",
        equivalent_table(study),
        "`0(exact)` has a smaller mean drift error (of no less than half the yield drift) than "
        + ", ".join(
            f"`{name}` in {beats(cells_of(study), name)}"
            for name in ("0(equiv)", *(t.name for t in CANDIDATES))
        )
        + " cases.",
    ]
    if study.stiffness:
        parts += [
            "Peak force of floor 2 and mean drift error under El Centro, literal reading, over the "
            "stiffness of "
            "the first diaphragm; Z1 = Z2 at 0.75. Only the contact with the duration of the touch "
            "jumps there.",
            shown("stiffness", "Equivalent contacts over the stiffness of the first diaphragm"),
            stiffness_table(study),
        ]
    if study.finer:
        lumped = [
            by_test(study.readings["literal"]["El Centro"])[name]
            for name in (
                "0(equiv)",
                "0(touch)",
                "0(centroid)",
                EXACT_EQUIVALENT.name,
                "1",
                "2",
                "5",
                BENCHMARK,
            )
        ]
        parts += [
            "Against more elements, El Centro, literal reading; n = 100 and 200 by `CENTRAL` with steps of "
            "2e-5 and 1e-5 s:",
            finer_table(study.finer, lumped),
            benchmark_told(study.finer, by_test(study.readings["literal"]["El Centro"])[BENCHMARK]),
        ]
    return parts


def rest(study: Study) -> list[str]:
    """Named systems, and single choices."""
    parts = []
    if study.systems:
        parts += [
            "## All systems named in the paper, and some others, El Centro, literal reading",
            systems_table(study.systems, benchmark_of(study.readings["literal"]["El Centro"])),
            "Drift errors are relative to distributed masses. Laws with a restitution have E = 0.65 (the "
            "multiplier 0; 1 where marked elastic) and the stiffness of the stiffer diaphragm; the Hertz "
            "laws have the stiffness that gives the same elastic force at 0.3 m/s. Rigid contacts strike "
            "with impulses, which have no peak force; that of the multiplier is the force of lasting "
            "contact. One record under one reading does not rank the laws.",
        ]
    if study.variants:
        head = [
            "variant", "closures, floor 1", "floor 2", "peak force [kN], floor 1", "floor 2",
            "smallest error of 0(10) [%]", "mean of 0(10) [%]", "mean 0(equiv) [%]", "mean n = 1 [%]",
            "largest n = 2 [%]",
        ]  # fmt: skip
        groups = {"literal reading": study.paper("literal")["El Centro"], **study.variants}
        rows = [sensitivity(name, group) for name, group in groups.items()]
        parts += ["## One choice changed, El Centro", table(head, rows)]
    return parts


def write(page: Path, folder: Path, study: Study) -> None:
    """Write the text into `page`, and its pictures into a folder beside or below it."""
    files = pictures(folder, study)

    def shown(name: str, text: str) -> str:
        return f"![{text}]({files[name].relative_to(page.parent).as_posix()})"

    parts = [
        *opening(study, shown),
        *evidence(study, shown),
        *contacts(study, shown),
        *practice(cells_of(study)),
        *rest(study),
    ]
    page.write_text("\n\n".join(parts) + "\n", encoding="utf-8", newline="\n")
