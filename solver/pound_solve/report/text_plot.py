"""Drawings of a curve without a library: characters for a terminal, SVG for the manual."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from textwrap import wrap
from typing import Final
from xml.sax.saxutils import escape

Curve = Sequence[tuple[float, float]]

_WIDTH, _HEIGHT = 480, 350  #: of the SVG [px]
_LEFT, _RIGHT, _TOP, _BOTTOM = 58, 14, 46, 46  #: its margins
_TITLE = 66  #: characters per line of its title
_STYLE: Final = (
    "text{font:13px sans-serif;fill:#222}.t{font-size:11px}.g{stroke:#ddd}.a{stroke:#666}"
    ".c{fill:none;stroke:#0b4f8a;stroke-width:1.6;stroke-linejoin:round}"
)


def letters(curve: Curve, width: int = 68, height: int = 22) -> str:
    """Draw a curve in characters.

    Parameters
    ----------
    curve : sequence of (x, y)
        Corners, joined by straight lines.
    width, height : int
        Columns and rows of the field.

    Returns
    -------
    str
        Lines without a final line end: the field with its zero lines, labelled with the ends of the axes.
    """
    (x0, x1), (y0, y1) = (_span([p[i] for p in curve]) for i in (0, 1))
    field = [[" "] * width for _ in range(height)]

    def place(x: float, y: float) -> tuple[int, int]:
        column = round((x - x0) / (x1 - x0) * (width - 1))
        return column, round((y1 - y) / (y1 - y0) * (height - 1))

    column, row = place(min(max(0.0, x0), x1), min(max(0.0, y0), y1))
    if y0 <= 0.0 <= y1:
        field[row] = ["-"] * width
    if x0 <= 0.0 <= x1:
        for line in field:
            line[column] = "+" if line[column] == "-" else "|"
    for a, b in pairwise(curve):
        _stroke(field, place(*a), place(*b))
    names = {0: f"{y1:.4g}", height - 1: f"{y0:.4g}"}
    if y0 < 0.0 < y1 and 0 < row < height - 1:
        names[row] = "0"
    wide = max(len(name) for name in names.values())
    lines = [f"{names.get(n, ''):>{wide}} {''.join(line)}".rstrip() for n, line in enumerate(field)]
    return "\n".join([*lines, " " * (wide + 1) + _foot(x0, x1, column, width)])


def _stroke(field: list[list[str]], start: tuple[int, int], end: tuple[int, int]) -> None:
    """Draw a straight line between two positions (column, row) of the field."""
    (ca, ra), (cb, rb) = start, end
    steps = max(abs(cb - ca), abs(rb - ra), 1)
    for n in range(steps + 1):
        field[round(ra + (rb - ra) * n / steps)][round(ca + (cb - ca) * n / steps)] = "*"


def _foot(x0: float, x1: float, zero: int, width: int) -> str:
    """Text below the x axis: both ends, and 0 at the column `zero` if there is space."""
    low, high = f"{x0:.4g}", f"{x1:.4g}"
    foot = low + " " * (width - len(low) - len(high)) + high
    if x0 < 0.0 < x1 and len(low) < zero < width - len(high) - 1:
        return foot[:zero] + "0" + foot[zero + 1 :]
    return foot


def svg(curve: Curve, title: str, x_name: str, y_name: str) -> str:
    """Draw a curve as an SVG picture.

    Parameters
    ----------
    curve : sequence of (x, y)
        Corners, joined by straight lines.
    title, x_name, y_name : str
        Texts above the picture, in up to two lines, and at its axes.

    Returns
    -------
    str
        The picture, the same on every machine: coordinates are rounded to a tenth of a pixel.
    """
    (x0, x1), (y0, y1) = (_span([p[i] for p in curve], 0.04) for i in (0, 1))
    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM

    def across(x: float) -> float:
        return _LEFT + (x - x0) / (x1 - x0) * (right - _LEFT)

    def down(y: float) -> float:
        return bottom - (y - y0) / (y1 - y0) * (bottom - _TOP)

    elements = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}">',
        f'<style>{_STYLE}</style><rect width="100%" height="100%" fill="#fff"/>',
        *(
            f'<text class="t" x="16" y="{18 + 16 * n}">{escape(line)}</text>'
            for n, line in enumerate(wrap(title, _TITLE, max_lines=2))
        ),
    ]
    for value in _ticks(x0, x1):
        x = _px(across(value))
        elements.append(f'<path class="{"a" if value == 0 else "g"}" d="M{x} {_TOP}V{bottom}"/>')
        elements.append(f'<text class="t" x="{x}" y="{bottom + 16}" text-anchor="middle">{value:g}</text>')
    for value in _ticks(y0, y1):
        y = _px(down(value))
        elements.append(f'<path class="{"a" if value == 0 else "g"}" d="M{_LEFT} {y}H{right}"/>')
        elements.append(
            f'<text class="t" x="{_LEFT - 6}" y="{y}" text-anchor="end" dy=".35em">{value:g}</text>'
        )
    middle, wide, high = (_TOP + bottom) // 2, right - _LEFT, bottom - _TOP
    elements += [
        f'<rect class="a" x="{_LEFT}" y="{_TOP}" width="{wide}" height="{high}" fill="none"/>',
        f'<text x="{(_LEFT + right) // 2}" y="{_HEIGHT - 10}" text-anchor="middle">{escape(x_name)}</text>',
        f'<text transform="translate(16 {middle}) rotate(-90)" text-anchor="middle">'
        f"{escape(y_name)}</text>",
        f'<path class="c" d="{_path([(across(x), down(y)) for x, y in curve])}"/>',
        "</svg>",
    ]
    return "\n".join(elements) + "\n"


def _span(values: Sequence[float], margin: float = 0.0) -> tuple[float, float]:
    """Smallest and largest value, separated if equal and widened by `margin`, a fraction of their range."""
    low, high = min(values), max(values)
    if low == high:
        low, high = low - 1.0, high + 1.0
    return low - margin * (high - low), high + margin * (high - low)


def _ticks(low: float, high: float) -> list[float]:
    """Four to eight round numbers between two values."""
    rough = (high - low) / 8.0
    size = 10.0 ** math.floor(math.log10(rough))
    step = next(size * m for m in (1.0, 2.0, 5.0, 10.0) if size * m >= rough)
    return [round(n * step, 12) + 0.0 for n in range(math.ceil(low / step), math.floor(high / step) + 1)]


def _px(x: float) -> str:
    return f"{x:.1f}".removesuffix(".0")


def _path(points: Curve) -> str:
    """SVG path through points, omitting those on the straight line between their neighbours."""
    kept: list[tuple[float, float]] = []
    for p in ((round(x, 1), round(y, 1)) for x, y in points):
        if kept and p == kept[-1]:
            continue
        if len(kept) > 1 and _between(kept[-2], kept[-1], p):
            kept[-1] = p
        else:
            kept.append(p)
    return "M" + "L".join(f"{_px(x)} {_px(y)}" for x, y in kept)


def _between(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> bool:
    """Whether b lies on the line from a to c, within 0.05 pixels."""
    dx, dy = c[0] - a[0], c[1] - a[1]
    length = math.hypot(dx, dy)
    if length == 0.0:
        return False
    off = abs(dx * (b[1] - a[1]) - dy * (b[0] - a[0])) / length
    along = (dx * (b[0] - a[0]) + dy * (b[1] - a[1])) / length
    return off < 0.05 and 0.0 <= along <= length
