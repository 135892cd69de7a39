"""Picture `animation`: the structure as it moves, as GIF, MP4, or a page that plays by itself."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from pound_solve.numerics.types import Array, Flags
from pound_solve.report.formats import ANIMATION_FORMATS
from pound_solve.report.plot import style
from pound_solve.report.plot.beams import Beam, Shift
from pound_solve.report.plot.geometry import (
    SHARE,
    WALL,
    Displacements,
    DrawnStructure,
    broken_line,
    displacements,
    draw_wall,
)
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results
from pound_solve.results.whole_file import write_text

FRAMES = 240  #: pictures of a film
RATE = 20  #: of them a second
PAGE = Path(__file__).parents[1] / "animation.html"


@dataclass(frozen=True, slots=True)
class Film:
    """Data of an animation: the structure and its displacements at the times of the frames.

    Attributes
    ----------
    displaced : Displacements
        The structure and its displacements at the times of the frames.
    title : str
    time : ndarray, shape (n,)
        Of the frames [T].
    closed : ndarray of bool, shape (n, n_contacts)
        Which contacts of the structure were closed at any instant since the frame before.
    """

    displaced: Displacements
    title: str
    time: Array
    closed: Flags


def film(results: Results, choice: Choice) -> Film:
    """Make the frames of the animation at equal intervals, interpolated between the stored instants."""
    displaced, t = displacements(results, choice.span(results)), results.time[choice.span(results)]
    time = np.linspace(t[0], t[-1], min(FRAMES, max(2, len(t))))
    drawn, opened = (_interpolated(time, t, x) for x in (displaced.drawn, displaced.opened))
    closed = [_closed(results, c.name, time) for c in displaced.structure.contacts]
    return Film(
        displaced._replace(drawn=drawn, opened=opened), results.title, time,
        np.array(closed, bool).reshape(-1, len(time)).T,
    )  # fmt: skip


def _interpolated(time: Array, t: Array, values: Array) -> Array:
    """Values at `time` out of those at `t` along the first axis."""
    columns = [np.interp(time, t, column) for column in values.reshape(len(t), -1).T]
    return np.array(columns).T.reshape(len(time), *values.shape[1:])


def _closed(results: Results, name: str, time: Array) -> Flags:
    """Whether a contact was closed between each frame and the one before, shape (n,)."""
    closed = np.zeros(len(time), bool)
    if "collisions" in results.tables:
        table = results.table("collisions")
        for hit in table[[str(c) == name for c in table["contact"]]]:
            end = hit["t_end"] if np.isfinite(hit["t_end"]) else np.inf
            closed |= (time >= hit["t_start"]) & (np.roll(time, 1) <= end) & (np.arange(len(time)) > 0)
    return closed


class AnimationFigure:
    """A figure in which the frames of a film are shown.

    Parameters
    ----------
    scene : Film
    """

    def __init__(self, scene: Film) -> None:
        s = self.structure = scene.displaced.structure
        self.film = scene
        self.figure = style.figure(*s.shape(), title=scene.title)
        self.axes = self.figure.add_subplot()
        s.frame(self.axes, 0.06 + SHARE)
        s.draw(self.axes, color="0.85", linewidth=0.8)
        s.draw_supports(self.axes)
        self.members = s.draw(self.axes, color=style.BLUE, linewidth=1.4)
        for c in s.contacts:
            if not c.j:
                draw_wall(self.axes, s.front(c), c.along, WALL * s.size)
        self.arms = self.axes.plot([], [], color=style.RED, linestyle="-", linewidth=1.4)[0]
        look = {"color": style.RED, "linestyle": ""}
        self.open = self.axes.plot([], [], marker="|", markersize=8, **look)[0]
        self.closed = self.axes.plot([], [], marker="o", markersize=10, **look)[0]
        self.axes.set_title(" ")

    def show(self, k: int) -> None:
        """Draw frame `k`."""
        film, s = self.film, self.structure
        moved = film.displaced.shift(k)
        self.members.set_data(*s.path(moved))
        ends = [s.ends(c, moved) for c in s.contacts]
        self.arms.set_data(*broken_line((start, tip) for start, tip, _ in ends))
        points = [(tip + end) / 2 if c.j else start for c, (start, tip, end) in zip(s.contacts, ends)]
        hit = film.closed[k]
        for line, chosen in ((self.open, ~hit), (self.closed, hit)):
            line.set_data(*np.array([p for p, c in zip(points, chosen) if c]).reshape(-1, 2).T)
        self.axes.set_title(caption(film, k))


def caption(scene: Film, k: int) -> str:
    """Text on a frame: its time, the magnification, and the contacts that are closed."""
    names = [c.name for c, closed in zip(scene.displaced.structure.contacts, scene.closed[k]) if closed]
    when = (
        f"{scene.time[k]:.2f} {scene.displaced.structure.units.time}, "
        f"displacements and gaps drawn {scene.displaced.factor:.3g} times as large"
    )
    return f"{when}; closed: {', '.join(names)}" if names else when


def animation(results: Results, choice: Choice) -> Any:
    """Draw the first frame."""
    stage = AnimationFigure(film(results, choice))
    stage.show(0)
    return stage.figure


def write(results: Results, choice: Choice, path: Path) -> None:
    """Write the film in the format of the file's ending."""
    animation = film(results, choice)
    if path.suffix == ".html":
        write_text(path, page(animation))
        return
    stage = AnimationFigure(animation)
    stage.show(0)
    style.arrange(stage.figure)
    style.film(stage.figure, stage.show, len(animation.time), path, RATE)


def page(scene: Film) -> str:
    """HTML page with the drawing, its data and the script that plays it, without other files."""
    s, nodes = scene.displaced.structure, scene.displaced.nodes
    still = [n for n in s.place if n not in nodes]
    at = {n: k for k, n in enumerate([*nodes, *still])}
    digits = max(0, 5 - int(np.floor(np.log10(s.size))))
    bent = [b for b in s.beams.values() if b.i in nodes and b.j in nodes]
    frames = range(len(scene.time))
    data = {
        "nodes": [np.round(s.place[n], digits).tolist() for n in at],
        "members": [[at[i], at[j]] for i, j in s.lines({b.element for b in bent})],
        "beams": [[at[b.i], at[b.j], *b.blocks, *b.along.tolist()] for b in bent],
        "contacts": [
            [at[c.i], at[c.j or c.i], *np.round(s.arm(c), digits).tolist()] for c in s.contacts
        ],
        "supports": [at[n] for n in s.place if {"X", "Y"} <= set(s.fixed[n])],
        "box": [*(s.low - 0.15 * s.size).tolist(), *(s.high + 0.15 * s.size).tolist()],
        "rate": RATE,
        "captions": [caption(scene, k) for k in frames],
        "moved": np.round(scene.displaced.drawn[..., :2], digits).reshape(len(frames), -1).tolist(),
        "turned": [np.round(turned(s, bent, scene.displaced.shift(k)), digits).tolist() for k in frames],
        "closed": scene.closed.astype(int).tolist(),
    }  # fmt: skip
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    head = PAGE.read_text(encoding="utf-8").replace("{{title}}", escape(scene.title))
    return head.replace("{{data}}", text)


def turned(s: DrawnStructure, bent: Sequence[Beam], shift: Shift) -> Array:
    """For each bent member, as the page needs them: rotations of its nodes, and those of its ends against
    its chord times a third of its length, shape (4 n,).
    """
    rows = [
        (
            *(shift.nodes[n][2] for n in (b.i, b.j)),
            *(b.bends(*b.ends(s.place, shift), shift) * b.length / 3.0),
        )
        for b in bent
    ]
    return np.array(rows).reshape(-1)


SPEC = Picture(
    name="animation",
    place=200,
    shows="the structure as it moves, as a page that plays by itself, a GIF or an MP4",
    needs=("node/u", "nodes", "elements"),
    draw=animation,
    options=("between",),
    endings=ANIMATION_FORMATS,
    write=write,
)
