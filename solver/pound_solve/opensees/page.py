"""The table of a comparison as text."""

from __future__ import annotations

import math

from pound_solve.opensees.verify import Compared, Comparison

HEADS = ("quantity", "ours", "at h", "at h/2", "at h/4", "order", "limit", "ours - limit", "uncertainty")


def page(comparison: Comparison) -> str:
    """Table of the peaks and a sentence on them."""
    rows = [_row(x) for x in comparison.rows]
    h = f"{comparison.program}, Newmark, h = {comparison.step:g}; ours: {comparison.method}"
    h += f", estimated error {comparison.error:.1e}" if comparison.error else ""
    return f"{h}\n\n{aligned([HEADS, *rows])}\n\n{sentence(comparison)}"


def aligned(rows: list[tuple[str, ...]]) -> str:
    """Rows as columns of equal width: names to the left, numbers to the right."""
    widths = [max(map(len, column)) for column in zip(*rows)]
    lines = []
    for name, *cells in rows:
        right = (cell.rjust(width) for cell, width in zip(cells, widths[1:]))
        lines.append("  ".join(["  " + name.ljust(widths[0]), *right]))
    return "\n".join(lines)


def _row(x: Compared) -> tuple[str, ...]:
    """Cells of a quantity."""
    values = (x.ours, *x.theirs)
    order = "-" if math.isnan(x.limit.order) else f"{x.limit.order:.2f}"
    tail = (f"{x.deviation:.1e}", f"{x.limit.uncertainty:.1e}")
    return (x.name, *(f"{v:.8g}" for v in values), order, f"{x.limit.value:.8g}", *tail)


def sentence(comparison: Comparison) -> str:
    """How far the peaks agree, in a sentence."""
    count, off = len(comparison.rows), [x for x in comparison.rows if not x.agrees]
    if not count:
        return "The deck stores no peak to compare."
    worst = max(comparison.rows, key=_relative)
    largest = f"the largest deviation from a limit is {_relative(worst):.1e} of it ({worst.name})"
    if not off:
        return f"All {count} peaks lie within the uncertainty of their limits; {largest}."
    names = ", ".join(x.name for x in off[:3]) + (", ..." if len(off) > 3 else "")
    return (
        f"{count - len(off)} of {count} peaks lie within the uncertainty of their limits, not {names}; "
        f"{largest}. A smaller --step shows whether the step or a difference of the models is the cause."
    )


def _relative(x: Compared) -> float:
    """Deviation over the limit."""
    return abs(x.deviation) / (abs(x.limit.value) or 1.0)
