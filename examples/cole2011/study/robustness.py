"""The paper's statements over many readings: in what share each holds, and which exclude one another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
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
    """One choice of strength, damping and columns; hardening is 2 %, and contacts with dashpots pull."""

    strength: float
    damping: float
    slabs: bool
    everywhere: bool
    params: Mapping[str, object] = field(compare=False, repr=False, default_factory=dict)


def structure(strength: float, damping: float, slabs: bool, everywhere: bool) -> Structure:
    """A structure with its PARAMs."""
    params = {
        "fy1": 2400 * strength, "fy2": 1400 * strength, "xi": damping, "slabs": int(slabs),
        "bays": "n" if everywhere else 1, "hard": 0.02, "stick": '"YES"',
    }  # fmt: skip
    return Structure(strength, damping, slabs, everywhere, params)


#: the literal one first, the best second; columns at all nodes that yield one by one cost too much to
#: be varied
STRUCTURES = (
    structure(1, 0.05, False, False),
    structure(2, 0.03, True, True),
    structure(2, 0.05, False, False),
    structure(1, 0.03, True, False),
    structure(2, 0.02, False, True),
    structure(1, 0.02, False, False),
    structure(2, 0.03, True, False),
    structure(1, 0.05, True, False),
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
        strict, lenient = (sum(bool(getattr(v, form_)) for v in found) for form_ in ("strict", "lenient"))
        lenient_share = share(max(strict, lenient), len(found)) if form.lenient else "-"
        rows.append([form.statement, str(len(found)), share(strict, len(found)), lenient_share])
    return rows


def excluded(readings: Sequence[Judged]) -> list[list[str]]:
    """Pairs of statements that each hold somewhere, as written, and nowhere together."""
    holds = {key: {n for n, (*_, v) in enumerate(readings) if v[key].strict} for key in FORMS}
    return [
        [FORMS[a].statement, str(len(holds[a])), FORMS[b].statement, str(len(holds[b]))]
        for a, b in combinations(FORMS, 2)
        if holds[a] and holds[b] and not holds[a] & holds[b]
    ]


def leading(readings: Sequence[Judged], most: int = 10) -> list[list[str]]:
    """The readings under which most statements hold as written."""
    counted = [(sum(v.strict is True for v in verdicts.values()), s, r) for s, r, verdicts in readings]
    counted.sort(key=lambda x: -x[0])
    return [
        [
            str(count), f"{s.strength:g}", f"{100 * s.damping:g} %", "yes" if s.slabs else "no",
            "all nodes" if s.everywhere else "ends", *(r.says for r in records),
        ]
        for count, s, records in counted[:most]
    ]  # fmt: skip


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
    head = ["yield / Table IV", "Rayleigh damping", "diaphragms damped", "columns"]
    parts = [
        "# Cole et al. (2011): which statements depend on the reading",
        f"Generated by `python examples/cole2011/readings`. {len(readings)} readings: {len(structures)} "
        f"structures "
        f"under {len({r for _, r in done})} records, all combinations; {runs} runs of `EXACT`, "
        f"{seconds:.0f} s of CPU time. Every structure has 2 % hardening, a contact of the softer "
        f"adjacent element, and dashpots "
        "that hold until the overlap is gone: the search before this one found that these matter least. "
        "The tests "
        "0(1), 3 and 4 are left out for time, and with them their part in the statements. Not varied: "
        "the stiffness of "
        "the contact, modal damping, P-Delta, single columns that yield one by one at Table IV's strength.",
        *(["Records without a file: " + "; ".join(left_out) + "."] if left_out else []),
        "The readings are no random sample, and a share is no probability: it says on how many of these "
        "equally "
        "admissible readings a statement rests.",
        "## How often each statement holds",
        table(robust(readings), ["statement", "readings", "holds as written", "holds leniently"]),
        "Statements on forces are judged where there is such a collision. The forms are those of "
        "[the study](cole2011-study.md#how-statements-are-judged).",
        "## Statements that exclude one another",
        table(excluded(readings), ["statement", "holds in", "and", "holds in"])
        if excluded(readings)
        else "None: any two that hold somewhere hold together somewhere.",
        "## The readings under which most statements hold",
        table(leading(readings), ["statements", *head, "El Centro", "Mexico City", "Loma Prieta"]),
        *practice([(structure.strength, runs) for (structure, _), runs in done.items()]),
        "## What was run",
        table(
            [
                [
                    f"{s.strength:g}",
                    f"{100 * s.damping:g} %",
                    "yes" if s.slabs else "no",
                    "all nodes" if s.everywhere else "ends",
                ]
                for s in structures
            ],
            head,
        ),
        table(
            [[r.name, r.says] for group in RECORDS for r in group if any(r == x for _, x in done)],
            ["earthquake", "record"],
        ),
    ]
    return "\n\n".join(parts) + "\n"
