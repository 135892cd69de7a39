"""The paper's statements over many readings: in what share each holds, and which exclude one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, product

from choices import (
    CAPITOLA,
    CORRALITOS_OWN,
    EL_CENTRO,
    EL_CENTRO_OLD,
    EL_CENTRO_OWN,
    GILROY_2,
    GILROY_3,
    LOMA_PRIETA,
    MEXICO,
    MEXICO_STRONG,
    Record,
)
from practice import practice
from runs import Run
from statements import FORMS, Verdict, judge
from tabulate import tabulate


@dataclass(frozen=True)
class Structure:
    """One choice of all that is no record.

    Attributes
    ----------
    strength : float
        Storey yield over that of Table IV.
    damping : float
        Rayleigh, at both sway modes.
    slabs, everywhere : bool
        Whether the diaphragms are damped, and whether columns stand at all their nodes.
    hardening : float
    pulls : bool
        Whether a contact with a dashpot holds until the overlap is gone.
    stiffer : bool
        Whether k_C is that of the stiffer adjacent element.
    """

    strength: float
    damping: float
    slabs: bool = False
    everywhere: bool = False
    hardening: float = 0.02
    pulls: bool = True
    stiffer: bool = False

    @property
    def params(self) -> dict[str, object]:
        """Values of the decks' PARAMs."""
        return {
            "fy1": 2400 * self.strength, "fy2": 1400 * self.strength, "xi": self.damping,
            "slabs": int(self.slabs), "bays": "n" if self.everywhere else 1, "hard": self.hardening,
            "stick": '"YES"' if self.pulls else '"NO"', "ka": "kd1" if self.stiffer else "kd2",
        }  # fmt: skip

    @property
    def row(self) -> list[str]:
        """Cells of a table, as `HEAD` names them."""
        return [
            f"{self.strength:g}", f"{100 * self.damping:g} %", "yes" if self.slabs else "no",
            "all nodes" if self.everywhere else "ends", f"{100 * self.hardening:g} %",
            "yes" if self.pulls else "no", "stiffer" if self.stiffer else "softer",
        ]  # fmt: skip


HEAD = (
    "yield / Table IV", "Rayleigh damping", "diaphragms damped", "columns", "hardening", "dashpot pulls",
    "contact as the element that is",
)  # fmt: skip
#: the best reading's, which is run under its own records in any case
BEST = Structure(2, 0.03, slabs=True, everywhere=True)
#: the literal reading's first; the best one's has columns at all nodes, which cost ten times as much
STRUCTURES = (
    Structure(1, 0.05, hardening=0.0, pulls=False),
    Structure(2, 0.05),
    Structure(1, 0.03, slabs=True),
    Structure(1, 0.05, slabs=True, stiffer=True),
    Structure(2, 0.02, slabs=True),
    BEST,
    Structure(1, 0.02, pulls=False),
    Structure(2, 0.05, slabs=True, hardening=0.0, pulls=False, stiffer=True),
    Structure(1, 0.0),
    Structure(2, 0.02, everywhere=True),
)
RECORDS = (
    (
        EL_CENTRO, EL_CENTRO_OWN, EL_CENTRO_OLD,
        replace(EL_CENTRO_OLD, sign=-1, says=EL_CENTRO_OLD.says + " × (−1)"),
        replace(EL_CENTRO, start=2.05, says="PEER 270 × (−1), 2.05 to 12.05 s"),
    ),
    (MEXICO, MEXICO_STRONG, replace(MEXICO_STRONG, sign=1, says="SCT E-W, 54.02 to 64.02 s")),
    (LOMA_PRIETA, CORRALITOS_OWN, GILROY_3, GILROY_2, CAPITOLA),
)  # fmt: skip
Cells = dict[tuple[Structure, Record], list[Run]]
#: one reading: its structure and records, and the verdicts on it
Judged = tuple[Structure, tuple[Record, ...], dict[str, Verdict]]


def judged(done: Cells) -> list[Judged]:
    """Verdicts on all combinations of a structure with a record of each earthquake."""
    out = []
    for structure in dict.fromkeys(s for s, _ in done):
        groups = [[r for r in group if (structure, r) in done] for group in RECORDS]
        for records in product(*(g for g in groups if g)):
            runs = {r.name: done[structure, r] for r in records}
            out.append((structure, records, judge(runs, structure.strength)))
    return out


def share(good: int, of: int) -> str:
    """A share of readings, in percent."""
    return f"{100 * good / of:.0f} %" if of else "-"


def robust(readings: Sequence[Judged]) -> list[list[str]]:
    """How often each statement holds, of the readings that have something to judge it by."""
    rows = []
    for key, form in FORMS.items():
        found = [verdicts[key] for *_, verdicts in readings if verdicts[key].strict is not None]
        strict = sum(v.strict is True for v in found)
        lenient = sum(v.strict is True or v.lenient is True for v in found)
        told = share(lenient, len(found)) if form.lenient else "-"
        rows.append([form.statement, str(len(found)), share(strict, len(found)), told])
    return rows


def excluded(readings: Sequence[Judged]) -> list[list[str]]:
    """Pairs of statements that each hold somewhere, as written, and nowhere together."""
    holds = {key: {n for n, (*_, v) in enumerate(readings) if v[key].strict} for key in FORMS}
    return [
        [FORMS[a].statement, str(len(holds[a])), FORMS[b].statement, str(len(holds[b]))]
        for a, b in combinations(FORMS, 2)
        if holds[a] and holds[b] and not holds[a] & holds[b]
    ]


def nowhere(readings: Sequence[Judged]) -> str:
    """The statements that hold as written in none of the readings."""
    never = [
        f'"{form.statement}"' for key, form in FORMS.items() if not any(v[key].strict for *_, v in readings)
    ]
    return (
        f"As written, these hold in none: {'; '.join(never)}."
        if never
        else "Each holds somewhere as written."
    )


def leading(readings: Sequence[Judged], most: int = 10) -> list[list[str]]:
    """The readings under which most statements hold as written."""
    counted = [(sum(v.strict is True for v in verdicts.values()), s, r) for s, r, verdicts in readings]
    counted.sort(key=lambda x: -x[0])
    return [[str(count), *s.row, *(r.says for r in records)] for count, s, records in counted[:most]]


def page(done: Cells, seconds: float, left_out: Sequence[str]) -> str:
    """The robustness page.

    Parameters
    ----------
    done : mapping
        All tests by structure and record.
    seconds : float
        CPU time of all runs [s].
    left_out : sequence of str
        Records without a file.
    """
    readings = judged(done)
    runs = sum(len(group) for group in done.values())
    table = partial(tabulate, tablefmt="pipe", disable_numparse=True)
    structures = list(dict.fromkeys(s for s, _ in done))
    kinds = [set(column) for column in zip(*(s.row for s in structures))]
    varied, fixed = ([h for h, k in zip(HEAD, kinds) if (len(k) > 1) == yes] for yes in (True, False))
    parts = [
        "# Cole et al. (2011): which statements depend on the reading",
        "Generated by `python examples/cole2011/readings --records FOLDER --structures N`, N being those "
        f"with all records below. {len(readings)} readings: {len(structures)} "
        f"structures under {len({r for _, r in done})} records; {runs} runs of `EXACT`, "
        f"{seconds:.0f} s of CPU time. What varies is {', '.join(varied)}, and the records; not varied are "
        f"{', '.join([*fixed, 'damping by other models than that of Rayleigh', 'P-Delta'])}. The best "
        "reading of [the study](cole2011-study.md#the-best-reading) is among them, its structure with its "
        "own records alone unless it is listed below in full.",
        *(["Records without a file: " + "; ".join(left_out) + "."] if left_out else []),
        "The readings are no random sample, and a share is no probability: it says on how many of these "
        "admissible readings a statement rests. Readings that share a structure and records are not "
        "independent of one another.",
        "## How often each statement holds",
        table(robust(readings), ["statement", "readings", "holds as written", "holds leniently"]),
        nowhere(readings),
        "Statements on forces are judged where there is such a collision. The forms are those of "
        "[the study](cole2011-study.md#how-statements-are-judged).",
        "## Statements that hold nowhere together",
        "Pairs that each hold as written under some of these readings, and under none together; where the "
        "numbers are small, more readings may join them.",
        table(excluded(readings), ["statement", "holds in", "and", "holds in"])
        if excluded(readings)
        else "None: any two that hold somewhere hold together somewhere.",
        "## The readings under which most statements hold",
        table(leading(readings), ["statements", *HEAD, "El Centro", "Mexico City", "Loma Prieta"]),
        *practice([(structure.strength, runs) for (structure, _), runs in done.items()]),
        "## What was run",
        table([[*s.row, str(sum(x == s for x, _ in done))] for s in structures], [*HEAD, "records"]),
        table(
            [[r.name, r.says] for group in RECORDS for r in group if any(r == x for _, x in done)],
            ["earthquake", "record"],
        ),
    ]
    return "\n\n".join(parts) + "\n"
