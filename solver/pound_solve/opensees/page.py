"""The table of a comparison as text."""

from __future__ import annotations

import math

from pound_solve.opensees.verify import DIFFERS, DOUBT, UNDECIDED, Compared, Comparison

HEADS = (
    "quantity", "ours", "at h", "at h/2", "at h/4", "order", "limit", "ours - limit", "uncertainty",
    "outcome",
)  # fmt: skip


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
    return (x.name, *(f"{v:.8g}" for v in values), order, f"{x.limit.value:.8g}", *tail, x.outcome)


def sentence(comparison: Comparison) -> str:
    """How far the peaks agree, in a few sentences."""
    rows = comparison.rows
    if not rows:
        return "The deck stores no peak to compare."
    differ, open_ = ([x for x in rows if x.outcome == kind] for kind in (DIFFERS, UNDECIDED))
    worst = max(rows, key=_relative)
    largest = f"the largest deviation from a limit is {_relative(worst):.1e} of it ({worst.name})"
    agree = len(rows) - len(differ) - len(open_)
    parts = [f"{agree} of {len(rows)} peaks lie within the uncertainty of their limits; {largest}."]
    if open_:
        parts.append(
            f"{len(open_)} are undecided, because that uncertainty is more than {100 * DOUBT:g} % "
            f"({_names(open_)}): give a smaller --step."
        )
    if differ:
        smaller = "--step, or a smaller --tol," if comparison.error else "--step"
        parts.append(
            f"{len(differ)} differ ({_names(differ)}): a smaller {smaller} shows whether the step or a "
            "difference of the models is the cause."
        )
    return " ".join([*parts, comparison.remark]).strip()


def _names(rows: list[Compared]) -> str:
    """Names of the first few."""
    return ", ".join(x.name for x in rows[:3]) + (", ..." if len(rows) > 3 else "")


def _relative(x: Compared) -> float:
    """Deviation over the size of the quantity."""
    return abs(x.deviation) / (x.size or 1.0)
