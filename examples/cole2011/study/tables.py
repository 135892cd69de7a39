"""Tables and pictures of the study: every number comes from the runs and from the closed forms."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from math import isnan
from pathlib import Path
from statistics import fmean

import figures
from cases import APART, BENCHMARK, EXACT_EQUIVALENT, PAIR, E
from choices import READINGS
from errors import benchmark_of, by_test, drifts, worst
from gathered import Group, Study
from robustness import Share, percent
from runs import PLACES, Run
from statements import FORMS, Verdict, forces, judge, mean, sensitivity, some
from tabulate import tabulate

from pound_solve.report.plot import style

NEAR = 1.2  #: times over T1 up to which a touch ends as the paper assumes


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


def inelastic() -> str:
    """Eqs 18 to 22 for the floors of Table IV, the first at 1 m/s, the second at rest."""
    lumped, distributed = PAIR.alpha_lumped, PAIR.alpha_paper

    def after(change: Sequence[float]) -> str:
        return f"{1 - change[0]:+.4f}, {change[1]:+.4f}"

    plastic = lumped
    elastic = [2 * a for a in distributed]
    mixed = [E * a + (1 - E) * b for a, b in zip(elastic, plastic)]
    rows = [
        ["18", "fully plastic, r = 0", after(plastic), "0"],
        ["19", f"lumped masses, e = {E}", after([(1 + E) * a for a in lumped]), f"{E}"],
        ["12", "distributed, elastic, r = 1", after(elastic), f"{PAIR.e_paper:.4f}"],
        ["20 to 22", f"distributed, r = {E}", after(mixed), f"{E * PAIR.e_paper:.4f}"],
        ["exact", f"distributed with the exact restitution, r = {E}",
         after([(1 + E * PAIR.e) * a for a in lumped]), f"{E * PAIR.e:.4f}"],
    ]  # fmt: skip
    return table(["equation", "collision", "velocities afterwards [m/s]", "restitution"], rows)


def verdicts_of(study: Study) -> dict[str, dict[str, Verdict]]:
    """Verdicts on all statements, by reading."""
    return {name: judge(study.paper(name), study.strength[name]) for name in study.readings}


def statements_table(study: Study, shares: Mapping[str, Share]) -> str:
    """Verdicts on every statement, in how many readings it holds, and on how much that rests."""
    judged = verdicts_of(study)
    rows = []
    for n, (key, form) in enumerate(FORMS.items(), 1):
        verdict = [v[key].word for v in judged.values()]
        share = shares.get(key)
        counted = f"{percent(share.strict, share.readings)} / " if share else "- / "
        counted += percent(share.lenient, share.readings) if share and form.lenient else "-"
        rows.append(
            [
                str(n),
                form.statement,
                *verdict,
                counted,
                rests([v[key].rests or "-" for v in judged.values()]),
            ]
        )
    head = ["", "statement", *judged, "readings, as written / leniently", "rests on"]
    return table(head, rows)


def rests(told: Sequence[str]) -> str:
    """On how much the verdicts of the readings rest; once where it is the same."""
    return told[0] if len(set(told)) == 1 else "; ".join(told)


def counted(study: Study) -> str:
    """How many statements hold in each reading."""
    told = []
    for name, verdicts in verdicts_of(study).items():
        strict = sum(v.strict is True for v in verdicts.values())
        more = sum(v.lenient is True for v in verdicts.values()) - strict
        told.append(f"{strict} of {len(FORMS)} as written and {more} more leniently ({name})")
    return ", ".join(told)


def reasons_list(reasons: Mapping[str, str]) -> str:
    """Why the statements hold or fail."""
    return "\n".join(f"{n}. {reasons[key]}" for n, key in enumerate(FORMS, 1))


def forms_table() -> str:
    """How every statement is judged."""
    rows = [
        [str(n), f.statement, str(f.page), f.strict, f.lenient or "-"]
        for n, f in enumerate(FORMS.values(), 1)
    ]
    return table(["", "statement", "page", "holds", "holds leniently"], rows)


def figures_table(study: Study) -> str:
    """Figures behind every verdict, by reading."""
    judged = verdicts_of(study)
    rows = [[str(n), *(v[key].figures for v in judged.values())] for n, key in enumerate(FORMS, 1)]
    return table(["", *judged], rows)


def plateau_table(study: Study) -> str:
    """Statements on Eq. 11 with the plateau as the recorded force."""
    judged = {name: forces(study.paper(name), "plateau") for name in study.readings}
    rows = [
        [FORMS[key].statement, *(f"{v[key].word}: {v[key].figures}" for v in judged.values())]
        for key in next(iter(judged.values()))
    ]
    return table(["statement", *judged], rows)


def apart_errors(study: Study) -> list[tuple[str, str, list[float]]]:
    """By reading and record the mean drift errors [%] of contacts with restitution and time of the paper,
    of the bars, and one of each.
    """
    out = []
    for reading, groups in study.readings.items():
        for record, group in groups.items():
            bench, strength = benchmark_of(group), study.strength[reading]
            errors = [
                fmean(abs(d.scaled) for d in drifts([by_test(group)[t.name]], bench, strength))
                for t in APART
            ]
            out.append((reading, record, errors))
    return out


def apart_means(study: Study) -> list[float]:
    """Their means over readings and records [%]."""
    return [fmean(column) for column in zip(*(errors for *_, errors in apart_errors(study)))]


def apart_table(study: Study) -> str:
    """Their table."""
    rows = [[*names, *(f"{x:.2f}" for x in errors)] for *names, errors in apart_errors(study)]
    means = ["mean", "", *(f"{x:.2f}" for x in apart_means(study))]
    return table(["reading", "record", *(t.name for t in APART)], [*rows, means])


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


def method_errors(study: Study) -> list[tuple[str, float, float, float]]:
    """By method the CPU time [s], and the largest errors of drifts and of the floors' peak forces [%],
    against the first method.
    """
    exact = study.methods[0][0]
    out = []
    for run, cost in study.methods:
        drift = worst(list(drifts([run], exact)))
        force = max(100 * abs(a / b - 1) for a, b in zip(run.forces, exact.forces))
        out.append((run.test, cost, drift, force))
    return out


def methods_table(errors: Sequence[tuple[str, float, float, float]]) -> str:
    """CPU time and errors of the methods."""
    rows = [
        [name, f"{cost:.1f}", *(f"{x:.2g}" if x else "-" for x in (drift, force))]
        for name, cost, drift, force in errors
    ]
    return table(["method, step", "CPU time [s]", "largest drift error [%]", "of peak forces [%]"], rows)


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


def benchmark_error(study: Study) -> float:
    """Mean drift difference of the benchmark from the finest mesh [%]; NaN where that was not run."""
    if not study.finer:
        return float("nan")
    bench = by_test(study.readings["literal"]["El Centro"])[BENCHMARK]
    return mean(list(drifts([bench], study.finer[-1])))


def benchmark_told(finer: Sequence[Run], bench: Run) -> str:
    """What the benchmark itself leaves open."""
    finest, coarser_steps = finer[-1], finer[-2]
    found = list(drifts([bench], finest))
    forces = " and ".join(f"{100 * (a / b - 1):+.1f} %" for a, b in zip(bench.forces, finest.forces))
    steps = worst(list(drifts([coarser_steps], finest)))
    peaks = max(abs(a / b - 1) for a, b in zip(coarser_steps.forces, finest.forces))
    return (
        f"The benchmark of {BENCHMARK} elements is itself {mean(found):.2f} % off 200 elements in the mean "
        f"of the drifts, {worst(found):.2f} % at most, and {forces} in the peak forces of the floors. "
        "Errors against it do not resolve smaller differences between models. Steps twice as long change "
        f"the drifts of 200 elements by {steps:.1g} % at most, and the peak forces by {100 * peaks:.1g} %. "
        "This was found for one record and one reading."
    )


def equivalent_table(study: Study) -> str:
    """Equivalent contacts beside few elements, against the benchmark, by reading and record."""
    names = ("0(equiv)", EXACT_EQUIVALENT.name, *(t.name for t in APART), "1", "2", "5")
    rows = []
    for reading, groups in study.readings.items():
        for record, group in groups.items():
            bench = benchmark_of(group)
            for name in names:
                run = by_test(group)[name]
                found = list(drifts([run], bench, study.strength[reading]))
                peaks = [f"{f:.0f}" for f in (*run.forces, *bench.forces)]
                scaled = fmean(abs(d.scaled) for d in found)
                errors = [f"{x:.2f}" for x in (mean(found), worst(found), scaled)]
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


def nearer_by_touch(study: Study) -> str:
    """In how many rows of the stiffness the contact that lasts as the bars touch has the smaller error."""
    gains = [
        mean(list(drifts([by_test(g)["0(exact)"]], benchmark_of(g))))
        - mean(list(drifts([by_test(g)["0(touch)"]], benchmark_of(g))))
        for g in study.stiffness.values()
    ]
    return f"{sum(x > 0 for x in gains)} of {len(gains)}"


def strong_touches(study: Study) -> list[tuple[str, str, list[float]]]:
    """By reading and record how long touches above 800 kN of the benchmark last, over T1."""
    out = []
    for reading, groups in study.readings.items():
        for record, group in groups.items():
            lasts = sorted(h.lasts / PAIR.first.period for h in benchmark_of(group).hits if h.peak > 800)
            if lasts:
                out.append((reading, record, lasts))
    return out


def parted(study: Study) -> tuple[int, int]:
    """How many strong touches end before 1.2 T1, and of how many."""
    every = [x for *_, lasts in strong_touches(study) for x in lasts]
    return sum(x < NEAR for x in every), len(every)


def parting_table(study: Study) -> str:
    """How long strong touches last in the benchmark, in collision periods."""
    rows = [
        [
            reading,
            record,
            str(len(lasts)),
            str(sum(x < NEAR for x in lasts)),
            ", ".join(f"{x:.2f}" for x in lasts),
        ]
        for reading, record, lasts in strong_touches(study)
    ]
    head = [
        "reading", "record", "touches above 800 kN", "part before 1.2 T1",
        "durations over T1 (T2 = 2.17 T1)",
    ]  # fmt: skip
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
            *(partial(errors_of, name=name) for name in ("0(equiv)", EXACT_EQUIVALENT.name, "2")),
        ):
            found = list(zip(*(of(g) for g in every)))
            columns += [f"{min(v):.4g} to {max(v):.4g}" for v in found]
        rows.append([reading, record, *columns])
    head = [
        "reading", "record", "peak force of test 20 [kN], floor 1", "floor 2", "its largest drift [mm]",
        "largest error, n = 2 [%]", "mean error, 0(equiv) [%]", "0(exact)", "n = 2",
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


def grounds_table(name: str) -> str:
    """Choices of a reading and their grounds."""
    grounds = next(r.grounds for r in READINGS if r.name == name)
    return table(["item", "choice", "ground"], grounds)


def variants_table(study: Study) -> str:
    """Main figures with one choice of the literal reading changed."""
    head = [
        "variant", "closures, floor 1", "floor 2", "peak force [kN], floor 1", "floor 2",
        "smallest error of 0(10) [%]", "mean of 0(10) [%]", "mean 0(equiv) [%]", "mean n = 1 [%]",
        "largest n = 2 [%]",
    ]  # fmt: skip
    groups = {"literal reading": study.paper("literal")["El Centro"], **study.variants}
    return table(head, [sensitivity(name, group) for name, group in groups.items()])


def pictures(folder: Path, study: Study) -> dict[str, Path]:
    """Draw all pictures; the file of each by its subject."""
    drawn: dict[str, partial[None]] = {
        "figure 5": partial(figures.snapshots),
        "figure 6": partial(figures.figure_6),
        "figure 7": partial(figures.figure_7),
        "figures 8 and 10": partial(figures.layout),
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
