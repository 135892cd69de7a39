"""Multilinear properties of links: springs whose rule has the curve as its backbone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Final

from pound_deck.diagnostics import mistake
from pound_import.draft import numbers
from pound_import.sap2000.link_elements import ElementWriter, LinkDof
from pound_import.sap2000.numbering import computed
from pound_import.sap2000.tables import SapRow

_SAME: Final = 1e-6  #: relative difference of values that are equal
_MOST_POINTS: Final = 100  #: of a curve


def elastic(writer: ElementWriter, at: LinkDof, rows: Sequence[SapRow]) -> None:
    """Add an elastic spring of one kink."""
    _curve(writer, at, rows, {1: "BILINEAR_ELASTIC"})


def plastic(writer: ElementWriter, at: LinkDof, rows: Sequence[SapRow]) -> None:
    """Add a spring of kinematic hardening, of one or two kinks."""
    kind = rows[0].word("HysType", "KINEMATIC")
    if kind != "KINEMATIC":
        what = f"{at.dof} of link {at.link[:40]}: hysteresis of the type {kind[:40].title()}"
        writer.lose(at.span, what, "add RULE to a SPRING")
        return
    _curve(writer, at, rows, {1: "BILINEAR", 2: "TRILINEAR"})


def _curve(writer: ElementWriter, at: LinkDof, rows: Sequence[SapRow], rules: Mapping[int, str]) -> None:
    """Add a spring whose rule has the curve as its backbone; `rules` are by the number of its kinks."""
    points = [
        (row.real(row.key("Displ", "Rotation")), row.real(row.key("Force", "Moment"))) for row in rows
    ]
    positive = [p for p in points if p[0] > 0.0][:_MOST_POINTS]
    negative = [p for p in reversed(points) if p[0] < 0.0][:_MOST_POINTS]
    ascending = all(a[0] < b[0] for a, b in pairwise(points))
    if not positive or not negative or not ascending or (0.0, 0.0) not in points:
        what = f"{at.dof} of link {at.link[:40]}: its curve does not ascend through zero"
        raise mistake("L643", what, rows[0].span, "Displ and Force from below zero to above, with 0, 0")
    sides = _branches(positive), _branches([(-d, -f) for d, f in negative])
    slopes, mirrored = ([slope for slope, _ in side] for side in sides)
    same = len(slopes) == len(mirrored) and all(
        abs(a - b) <= _SAME * slopes[0] for a, b in zip(slopes, mirrored)
    )
    rule = rules.get(len(slopes) - 1)
    if len(slopes) == 1 and same and slopes[0] > 0.0:
        writer.spring(at, slopes[0], "", [])
    elif not rule or not same or slopes[0] <= 0.0:
        what = f"{at.dof} of link {at.link[:40]}: a curve that no rule has as its backbone"
        writer.lose(at.span, what, "add a SPRING with the nearest RULE")
    else:
        plus, minus = sides[::-1] if at.reverse else sides
        kinks = [(a[1], b[1]) for a, b in zip(plus, minus)][1:]
        _backbone(writer, at, slopes, kinks, rule, rows[0])


def _backbone(
    writer: ElementWriter,
    at: LinkDof,
    slopes: list[float],
    kinks: list[tuple[float, float]],
    rule: str,
    row: SapRow,
) -> None:
    """Add a spring of several slopes; `kinks` are the forces where they change, on either side."""
    (plus, minus), notes = kinks[0], list[str]()
    for name, slope in zip(("R", "R2"), slopes[1:]):
        writer.within(rule, name, slope / slopes[0], row, "Force")
    items = (
        f" {at.item('FX', 'MR')}={numbers((plus, -minus))} RULE={rule} R={computed(slopes[1] / slopes[0])}"
    )
    if rule == "TRILINEAR":
        second = f"{computed(kinks[1][0] / plus)},{computed(kinks[1][1] / minus)}"
        items += f" R2={computed(slopes[2] / slopes[0])} F2={second}"
        notes.append(
            writer.draft.doubt(row.span, "kinematic hardening of several slopes is that of TRILINEAR")
        )
    writer.spring(at, slopes[0], items, notes)


def _branches(side: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Slope of each branch from zero outwards, and the force where it begins; equal neighbours are one."""
    out: list[tuple[float, float]] = []
    for (d0, f0), (d1, f1) in zip([(0.0, 0.0), *side], side):
        slope = (f1 - f0) / (d1 - d0)
        if not out or abs(slope - out[-1][0]) > _SAME * abs(out[0][0]):
            out.append((slope, f0))
    return out
