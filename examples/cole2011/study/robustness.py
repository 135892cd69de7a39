"""The paper's statements over many readings: in what share each holds, and which exclude one another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product

from choices import HEAD, Structure
from motions import RECORDS, Record
from runs import Run
from statements import FORMS, Verdict, forces, of_drifts

Cells = Mapping[tuple[Structure, Record], Sequence[Run]]
#: what is taken for the recorded force: the true peak, or the largest of stored samples
RECORDED = ("peak", "1 ms", "2 ms")
#: whether a statement holds as written: in these shares of readings and more, or less, or in between
KINDS = ("mostly", "rarely", "depends")
MOST, FEW = 0.75, 0.05


@dataclass(frozen=True)
class Judged:
    """One reading, and the verdicts on it.

    Attributes
    ----------
    recorded : str
        Member of `RECORDED`.
    """

    structure: Structure
    records: tuple[Record, ...]
    recorded: str
    verdicts: Mapping[str, Verdict]


@dataclass(frozen=True)
class Share:
    """In how many readings a statement can be judged, holds as written, and holds at least leniently."""

    readings: int
    strict: int
    lenient: int

    @property
    def kind(self) -> str:
        """Member of `KINDS`."""
        if self.strict >= MOST * self.readings:
            return "mostly"
        return "rarely" if self.strict <= FEW * self.readings else "depends"


def judged(done: Cells) -> list[Judged]:
    """Verdicts on all combinations of a structure, a record of each earthquake, and a recorded force."""
    out = []
    for structure in dict.fromkeys(s for s, _ in done):
        groups = [[r for r in group if (structure, r) in done] for group in RECORDS]
        for records in product(*(g for g in groups if g)):
            runs = {r.name: done[structure, r] for r in records}
            drifts = of_drifts(runs, structure.strength)
            for of in RECORDED:
                out.append(Judged(structure, records, of, {**drifts, **forces(runs, of)}))
    return out


def shares(readings: Sequence[Judged]) -> dict[str, Share]:
    """How often each statement holds, of the readings that have something to judge it by."""
    out = {}
    for key in FORMS:
        found = [r.verdicts[key] for r in readings if r.verdicts[key].strict is not None]
        strict, lenient = (sum(v.strict is True for v in found), sum(v.lenient is True for v in found))
        out[key] = Share(len(found), strict, lenient)
    return out


def percent(good: int, of: int) -> str:
    """A share of readings, in percent."""
    return f"{100 * good / of:.0f} %" if of else "-"


def share_rows(readings: Sequence[Judged]) -> list[list[str]]:
    """How often each statement holds, over all readings and with each recorded force."""
    rows = []
    for key, share in shares(readings).items():
        by_force = [shares([r for r in readings if r.recorded == of])[key] for of in RECORDED]
        lenient = percent(share.lenient, share.readings) if FORMS[key].lenient else "-"
        rows.append(
            [
                FORMS[key].statement, str(share.readings), percent(share.strict, share.readings), lenient,
                *(percent(s.strict, s.readings) for s in by_force), share.kind,
            ]
        )  # fmt: skip
    return rows


def excluded(readings: Sequence[Judged]) -> list[list[str]]:
    """Pairs of statements that each hold somewhere, as written, and nowhere together."""
    holds = {key: {n for n, r in enumerate(readings) if r.verdicts[key].strict} for key in FORMS}
    return [
        [FORMS[a].statement, str(len(holds[a])), FORMS[b].statement, str(len(holds[b]))]
        for a, b in combinations(FORMS, 2)
        if holds[a] and holds[b] and not holds[a] & holds[b]
    ]


def count(reading: Judged) -> tuple[int, int]:
    """Number of statements that hold as written, and of those that hold leniently only."""
    strict = sum(v.strict is True for v in reading.verdicts.values())
    return strict, sum(v.lenient is True for v in reading.verdicts.values()) - strict


LEADING_HEAD = (
    "statements",
    "leniently",
    *HEAD,
    "recorded force",
    "El Centro",
    "Mexico City",
    "Loma Prieta",
)


def leading(readings: Sequence[Judged], most: int = 6) -> list[list[str]]:
    """The readings under which most statements hold as written."""
    ranked = sorted(readings, key=count, reverse=True)[:most]
    return [
        [*map(str, count(r)), *r.structure.row, r.recorded, *(x.says for x in r.records)] for r in ranked
    ]


def varied(structures: Sequence[Structure]) -> tuple[list[str], list[str]]:
    """Names of what varies among some structures, and of what does not."""
    kinds = [set(column) for column in zip(*(s.row for s in structures))]
    return ([h for h, k in zip(HEAD, kinds) if len(k) > 1], [h for h, k in zip(HEAD, kinds) if len(k) == 1])
