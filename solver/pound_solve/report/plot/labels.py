"""Labels that never overprint: each takes the first free place beside its point, or none.

A picture adds its labels with `label`; when all is drawn, `settle` gives them their places in the order in
which they were added.  A place is free where the text covers no other text and no point, lies within the
axes, and is not nearer to the point of another label than to its own; among free places, the one that
covers the fewest lines and shaded areas is taken.  A label without a free place is left out.  Nothing is
left to chance: equal pictures have equal labels.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from pound_solve.numerics.types import Array, Flags
from pound_solve.report.plot import style

WAITING: Final = "label without a place"
ROOM = 2.5  #: free pixels around a text
POINT = 3.0  #: least half the size of a point that a text should not cover, in pixels
SAME = 4.0  #: pixels within which points are one, as nodes on both sides of a gap
#: sides on which a label may stand: direction, and which corner of the text points at it
SIDES: Final = (
    (1, 1, "left", "bottom"),
    (-1, 1, "right", "bottom"),
    (1, -1, "left", "top"),
    (-1, -1, "right", "top"),
    (0, 1, "center", "bottom"),
    (0, -1, "center", "top"),
    (1, 0, "left", "center"),
    (-1, 0, "right", "center"),
)
DISTANCES: Final = (6.0, 9.0, 16.0, 28.0, 44.0)  #: from the point, in points of print


def label(axes: Any, at: Any, text: str, far: bool = False, side: Any = (0.0, 0.0), **look: Any) -> None:
    """Add a label to a point of the axes, not against the direction `side` from it; one that may stand
    `far` from it gets a line to it.
    """
    look.setdefault("fontsize", 6.5)
    arrow = {"arrowstyle": "-", "color": "0.5", "linewidth": 0.5, "shrinkA": 0, "shrinkB": 1}
    drawn = axes.annotate(
        text, at, xytext=side, textcoords="offset points", gid=WAITING,
        arrowprops=arrow if far else None, annotation_clip=False, **look,
    )  # fmt: skip
    drawn.set_in_layout(False)


def settle(figure: Any) -> None:
    """Arrange a figure, and give its labels their places, or take them out."""
    waiting = [(axes, [t for t in axes.texts if t.get_gid() == WAITING]) for axes in figure.axes]
    for text in (text for _, texts in waiting for text in texts):
        text.set_visible(False)
    style.arrange(figure)
    for axes, texts in waiting:
        if texts:
            _settle(axes, texts)


def _settle(axes: Any, texts: list[Any]) -> None:
    taken = [t.get_window_extent().extents for t in axes.texts if t.get_visible() and t.get_text()]
    lines, points = _drawn(axes)
    areas = [patch.get_path().transformed(patch.get_transform()) for patch in axes.patches]
    window = axes.get_window_extent().extents + np.array([-ROOM, -ROOM, ROOM, ROOM])
    near = [t for t in texts if t.arrow_patch is None]
    anchors = axes.transData.transform(np.reshape([t.xy for t in near], (-1, 2)))
    for text in texts:
        text.set_gid(None)
        place = _place(text, window, taken, (lines, areas), points, anchors)
        if place is None:
            text.remove()
            continue
        taken.append(place)
        text.set_visible(True)


def _place(
    text: Any, window: Array, taken: list[Array], drawn: tuple[Array, list[Any]], points: Array,
    anchors: Array,
) -> Array | None:  # fmt: skip
    """Move a text to its best free place, and return the box that it takes there, in pixels; `drawn` are
    lines and areas.
    """
    text.set_visible(True)
    best: tuple[int, Array, tuple[Any, ...]] | None = None
    others = np.array(taken).reshape(-1, 4)
    far = text.arrow_patch is not None
    lines, areas = drawn
    side = text.get_position()
    for distance in DISTANCES if far else DISTANCES[:1]:
        for dx, dy, across, up in SIDES:
            if dx * side[0] + dy * side[1] < 0.0:
                continue
            how = (dx * distance, dy * distance), across, up
            _move(text, *how)
            # the text alone: its line to the point may cross others
            box = style.text_box(text) + np.array([-ROOM, -ROOM, ROOM, ROOM])
            inside = (box[:2] >= window[:2]).all() and (box[2:] <= window[2:]).all()
            if not inside or _overlap(box, others).any() or _overlap(box, points).any():
                continue
            if not far and _nearer(box, text.axes.transData.transform(text.xy), anchors):
                continue
            hidden = int(_crossed(box, lines).sum()) + _within(box, areas)
            if best is None or hidden < best[0]:
                best = hidden, box, how
        if best is not None and best[0] == 0:
            break
    text.set_visible(False)
    if best is None:
        return None
    _move(text, *best[2])
    return best[1]


def _move(text: Any, offset: tuple[float, float], across: str, up: str) -> None:
    text.set_position(offset)
    text.set_horizontalalignment(across)
    text.set_verticalalignment(up)


def _drawn(axes: Any) -> tuple[Array, Array]:
    """Pieces of the lines of the axes, shape (n, 4), and boxes of their marked points, in pixels."""
    pieces, points = [np.zeros((0, 4))], [np.zeros((0, 4))]
    for line in axes.get_lines():
        if line.get_transform() != axes.transData:
            continue  # across the whole axes
        xy = axes.transData.transform(np.column_stack(line.get_data()).astype(float))
        if line.get_linestyle() not in ("None", ""):
            pieces.append(np.hstack([xy[:-1], xy[1:]]))
        if line.get_marker() not in ("None", "", None):
            half = max(POINT, 0.5 * line.get_markersize() * axes.figure.dpi / 72.0)
            points.append(np.hstack([xy - half, xy + half]))
    drawn, marked = np.concatenate(pieces), np.concatenate(points)
    return drawn[np.isfinite(drawn).all(axis=1)], marked[np.isfinite(marked).all(axis=1)]


def _overlap(box: Array, others: Array) -> Flags:
    """Whether a box overlaps each of other boxes, shape (n,)."""
    overlaps: Flags = (
        (others[:, 0] < box[2])
        & (others[:, 2] > box[0])
        & (others[:, 1] < box[3])
        & (others[:, 3] > box[1])
    )
    return overlaps


def _nearer(box: Array, anchor: Array, anchors: Array) -> bool:
    """Whether the middle of a box is nearer to another of the `anchors` than to its own `anchor`."""
    middle = 0.5 * (box[:2] + box[2:])
    away = np.hypot(*(anchors - middle).T)
    return bool((away < np.hypot(*(anchor - middle)) - SAME).any())


def _within(box: Array, areas: list[Any]) -> int:
    """Number of areas (paths) that the middle of a box lies in."""
    middle = 0.5 * (box[:2] + box[2:])
    return sum(bool(area.contains_point(middle)) for area in areas)


def _crossed(box: Array, lines: Array) -> Flags:
    """Whether a box touches each piece of lines, shape (n,), by the clipping of Liang and Barsky."""
    start, step = lines[:, :2], lines[:, 2:] - lines[:, :2]
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (box[:2] - start) / step, (box[2:] - start) / step
    within = (start >= box[:2]) & (start <= box[2:])
    enter = np.where(step == 0.0, np.where(within, -np.inf, np.inf), np.fmin(a, b)).max(axis=1)
    leave = np.where(step == 0.0, np.where(within, np.inf, -np.inf), np.fmax(a, b)).min(axis=1)
    crossed: Flags = (enter <= leave) & (enter <= 1.0) & (leave >= 0.0)
    return crossed
