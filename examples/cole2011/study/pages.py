"""The pages of the study: the texts of `texts`, filled with tables, numbers and pictures."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import figures
import tables
from cases import BENCHMARK, EXACT_EQUIVALENT, KD1, KD2, PAIR, TRADITIONAL, E, G
from choices import HEAD
from errors import benchmark_of, by_test
from gathered import Study
from practice import Cell, median_error, peaks, practice, times
from reasons import first_force, reasons
from robustness import (
    KINDS,
    LEADING_HEAD,
    RECORDED,
    Judged,
    Share,
    count,
    excluded,
    judged,
    leading,
    percent,
    share_rows,
    shares,
    varied,
)
from statements import FORMS

from pound_solve.report.plot import style

TEXTS = Path(__file__).with_name("texts")
MANUAL = Path(__file__).resolve().parents[3] / "manual"
PAGES = ("study", "annex", "readings")
NOT_RUN = "Not run."
STOREY = 3.5  #: assumed height of a storey, that of the decks [m]
WIDTH, THICKNESS = 10.0, 0.15  #: of the slab: Figure 8, and a usual one [m]
Fill = Mapping[str, str]


def filled(name: str, fill: Fill, shown: Callable[[str, str], str]) -> str:
    """Return a text with all its marks replaced.

    Raises
    ------
    KeyError
        A mark has no replacement.
    """

    def replaced(mark: re.Match[str]) -> str:
        if mark[1].startswith("picture "):
            subject, _, text = mark[1].removeprefix("picture ").partition(": ")
            return shown(subject, text)
        return fill[mark[1]]

    source = (TEXTS / f"{name}.md.in").read_text(encoding="utf-8")
    text = re.sub(r"<<([^<>\n]+)>>", replaced, source)
    return re.sub(r"\n{3,}", "\n\n", text).strip() + "\n"


def write(out: Path, manual: Path | None, study: Study) -> None:
    """Write the three pages and their pictures into a folder, or as pages of the manual."""
    names = {name: f"{'cole2011-' if manual else ''}{name}.md" for name in PAGES}
    folder = manual or out
    drawn = folder / "study" if manual else folder
    drawn.mkdir(parents=True, exist_ok=True)
    files = tables.pictures(drawn, study)

    def shown(subject: str, text: str) -> str:
        if subject not in files:
            return NOT_RUN
        return f"![{text}]({files[subject].relative_to(folder).as_posix()})"

    readings = judged(study.cells)
    links = {**names, "readings page": names["readings"], "readings": str(len(readings) or "no")}
    of_manual = Path(os.path.relpath(MANUAL, folder))
    fill = {
        **links,
        "theory": (of_manual / "theory-pounding.md").as_posix(),
        "theory of contacts": (of_manual / "theory-contact.md").as_posix(),
        "left out": left_out(study),
        **of_theory(study),
        "distinct": str(len(readings) // len(RECORDED)),
        **of_statements(study, shares(readings) if readings else {}, shown),
        **of_annex(study, shown),
        **of_readings(study, readings),
    }
    if manual and study.methods and readings:
        paper = manual / "paper"
        paper.mkdir(exist_ok=True)
        text = filled("paper", {**fill, **of_paper(study, readings, paper)}, shown)
        (paper / "paper.md").write_text(text, encoding="utf-8", newline="\n")
    for name in PAGES:
        (folder / names[name]).write_text(filled(name, fill, shown), encoding="utf-8", newline="\n")


def of_paper(study: Study, readings: Sequence[Judged], folder: Path) -> dict[str, str]:
    """Numbers of the paper; draw its figures into the folder."""
    found = shares(readings)
    bars = [(key, *(100 * n / s.readings for n in (s.strict, s.lenient))) for key, s in found.items()]
    errors = tables.method_errors(study)
    with style.sheet():
        figures.share_bars(bars, folder / "shares.png")
        figures.methods([(name, cost, drift) for name, cost, drift, _ in errors], folder / "methods.png")
    kinds = [s.kind for s in found.values()]
    cells = cells_of(study)
    return {
        "methods": tables.methods_table(errors),
        **{f"{kind} count": str(kinds.count(kind)) for kind in KINDS},
        "most": str(max(count(r)[0] for r in readings)),
        "cases": str(len(cells)),
        "exact median": f"{median_error(cells, EXACT_EQUIVALENT.name):.1f}",
        "usual medians": ", ".join(f"{median_error(cells, name):.1f}" for name in reversed(TRADITIONAL)),
    }


def left_out(study: Study) -> str:
    """What was left out, or done otherwise."""
    if not study.left_out:
        return ""
    return "Left out, or done otherwise:\n\n" + "\n".join(f"- {line}" for line in study.left_out)


def of_theory(study: Study) -> dict[str, str]:
    """Numbers and tables of closed forms, and of restitution and time."""
    stiffness = KD1 * 20.0  # EA; KD2 times 50 m is the same
    assert abs(stiffness - KD2 * 50.0) < 1e-6 * stiffness
    p_delta = 2.0 * PAIR.second.mass * G / STOREY / 350000.0
    apart = tables.apart_means(study)
    return {
        "Z1": f"{PAIR.first.impedance:.0f}",
        "Z2": f"{PAIR.second.impedance:.0f}",
        "T1": f"{PAIR.first.period:.4f}",
        "T2": f"{PAIR.second.period:.4f}",
        "e exact": f"{PAIR.e:.3f}",
        "e paper": f"{PAIR.e_paper:.3f}",
        "EA": f"{stiffness:,.0f}".replace(",", " "),
        "E": f"{stiffness / (WIDTH * THICKNESS) / 1000:.0f}",
        "h": f"{STOREY:g}",
        "p-delta": f"{100 * p_delta:.1f}",
        "r": f"{E:g}",
        "table iv": tables.table_iv(),
        "inelastic": tables.inelastic(),
        "parted": "{} of {}".format(*tables.parted(study)),
        "parting": tables.parting_table(study),
        "apart": tables.apart_table(study),
        **{f"apart {n}": f"{mean:.2f}" for n, mean in enumerate(apart, 1)},
    }


def cells_of(study: Study) -> list[Cell]:
    """Every structure under every record."""
    return [Cell(s.strength, group, s.contact == "softer") for (s, _), group in study.cells.items()]


def of_statements(
    study: Study, found: Mapping[str, Share], shown: Callable[[str, str], str]
) -> dict[str, str]:
    """Verdicts on the statements, and what follows from them."""

    def kind(name: str) -> str:
        lines = [
            f"- {form.statement} ({percent(found[key].strict, found[key].readings)} of the readings)."
            for key, form in FORMS.items()
            if found and found[key].kind == name
        ]
        return "\n".join(lines) or f"- {'none' if found else NOT_RUN}"

    names = list(study.readings)
    last = names[-1]
    figures = [f"figure {n} {last}: Figure {n}, {last} reading" for n in (11, 12, 13, 14)]
    cells = cells_of(study)
    return {
        "number of statements": str(len(FORMS)),
        **{name: kind(name) for name in KINDS},
        "names": ", ".join(names[:-1]) + " and " * (len(names) > 1) + last,
        "counted": tables.counted(study),
        "statements": tables.statements_table(study, found),
        "error at peaks": first_force(study),
        "five force": times(peaks(cells, "5")),
        "reasons": tables.reasons_list(reasons(study)),
        "pictures 11 to 14 modal": "\n\n".join(shown(*f.split(": ")) for f in figures),
        "usual force": times([x for name in TRADITIONAL for x in peaks(cells, name)]),
        "exact force": times(peaks(cells, EXACT_EQUIVALENT.name)),
        "practice": practice(cells, tables.benchmark_error(study)) if cells else NOT_RUN,
        **{f"grounds {name}": tables.grounds_table(name) for name in ("literal", "Rayleigh", "modal")},
    }


def of_annex(study: Study, shown: Callable[[str, str], str]) -> dict[str, str]:
    """Tables of the annex."""
    literal = study.readings["literal"]["El Centro"]
    bench = benchmark_of(literal)
    lumped = [by_test(literal)[n] for n in ("0(equiv)", "0(exact)", "1", "2", "5", BENCHMARK)]
    finer = study.finer
    return {
        "forms": tables.forms_table(),
        "figures": tables.figures_table(study),
        "plateau": tables.plateau_table(study),
        "evidence": evidence(study, shown),
        "ranges": f"{tables.ranges_table(study)}\n\n{tables.below_five(study)}"
        if study.disturbed
        else NOT_RUN,
        "equivalents": tables.equivalent_table(study),
        "nearer by touch": tables.nearer_by_touch(study) if study.stiffness else "no",
        "stiffness": tables.stiffness_table(study) if study.stiffness else NOT_RUN,
        "finer": f"{tables.finer_table(finer, lumped)}\n\n{tables.benchmark_told(finer, bench)}"
        if finer
        else NOT_RUN,
        "systems": tables.systems_table(study.systems, bench) if study.systems else NOT_RUN,
        "variants": tables.variants_table(study) if study.variants else NOT_RUN,
    }


def evidence(study: Study, shown: Callable[[str, str], str]) -> str:
    """Drifts and forces by reading and record."""
    parts = []
    for name, groups in study.readings.items():
        parts += [
            f"## Drifts and forces, {name} reading (Figures 9 and 11 to 14)",
            shown(f"figure 9 {name}", f"Scaled input (Figure 9), {name} reading"),
            *(shown(f"figure {n} {name}", f"Figure {n}, {name} reading") for n in (11, 12, 13, 14)),
        ]
        for record in groups:
            group = study.paper(name)[record]
            parts += [
                f"### {record}, {name} reading",
                tables.table(tables.CONTACT_HEAD, tables.contact_rows(group)),
                tables.drift_table(group, study.strength[name]),
            ]
    return "\n\n".join(parts)


def of_readings(study: Study, readings: Sequence[Judged]) -> dict[str, str]:
    """Tables of the page of readings."""
    names = (
        "structures",
        "records",
        "runs",
        "seconds",
        "varied",
        "fixed",
        "shares",
        "excluded",
        "leading",
        "run",
    )
    if not readings:
        return dict.fromkeys((*names, "records run"), NOT_RUN)
    structures = list(dict.fromkeys(s for s, _ in study.cells))
    records = list(dict.fromkeys(r for _, r in study.cells))
    among, fixed = varied(structures)
    pairs = excluded(readings)
    head = [
        "statement", "readings", "holds as written", "holds leniently",
        *(f"as written, {x}" for x in RECORDED), "so it is",
    ]  # fmt: skip
    run = [[*s.row, str(sum(x == s for x, _ in study.cells))] for s in structures]
    return {
        "structures": str(len(structures)),
        "records": str(len(records)),
        "seconds": f"{study.seconds:.0f}",
        "runs": str(sum(len(group) for group in study.cells.values())),
        "varied": ", ".join(among),
        "fixed": ", ".join([*fixed, "P-Delta"]),
        "shares": tables.table(head, share_rows(readings)),
        "excluded": tables.table(["statement", "holds in", "and", "holds in"], pairs)
        if pairs
        else "None: any two that hold somewhere hold together somewhere.",
        "leading": tables.table(LEADING_HEAD, leading(readings)),
        "run": tables.table([*HEAD, "records"], run),
        "records run": tables.table(["earthquake", "record"], [[r.name, r.says] for r in records]),
    }
