"""Fibres of a section: areas and places across it, summed where they share both place and material."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

from pound_import.opensees.backbones import Stress, backbone, is_concrete
from pound_import.opensees.commands import Command
from pound_import.opensees.model import ScriptModel

_MOST: Final = 100_000  #: fibres of a section


class Fibre(NamedTuple):
    """A fibre: distance from the axis of the section [L], area [L^2], stress of its first loading."""

    y: float
    area: float
    stress: Stress


class Fibres(NamedTuple):
    """Fibres of a section, and whether some are concrete."""

    fibres: tuple[Fibre, ...]
    cracks: bool


def fibres(model: ScriptModel, tag: int, user: Command) -> Fibres:
    """Fibres of a section.

    Raises
    ------
    Mistake
        A patch or layer is incomplete, or the first loading of a material is not known.
    """
    section = model.sections[tag]
    commands = model.fibres.get(tag, [])
    if section.words[1] == "WFSection2d":
        commands = list(_wide_flange(section))
    areas: dict[tuple[float, int], float] = {}
    count = 0
    for command in commands:
        material, parts = _KINDS.get(command.name, _single)(command)
        for y, area in parts:
            count += 1
            if count > _MOST:
                raise command.mistake(f"section {tag} has more than {_MOST} fibres", code="L620")
            key = float(f"{y:.12g}"), material
            areas[key] = areas.get(key, 0.0) + area
    if not areas:
        raise user.mistake(f"section {tag} has no fibres", code="L620")
    stresses = {material: backbone(model, material, section) for _, material in areas}
    made = tuple(Fibre(y, area, stresses[material]) for (y, material), area in sorted(areas.items()))
    return Fibres(made, any(is_concrete(model, material) for _, material in areas))


Placed = tuple[int, Iterator[tuple[float, float]]]


def _single(command: Command) -> Placed:
    """``fiber``: y z area material."""
    y, _, area = command.reals(1, "y z A")
    return command.whole(4, "the material"), iter([(y, area)])


def _patch(command: Command) -> Placed:
    """``patch``: rect, quad or circ of cells."""
    kind = command.word(1, "the kind")
    material = command.whole(2, "the material")
    counts = command.whole(3, "the count"), command.whole(4, "the count")
    if not all(0 < n <= _MOST for n in counts) or counts[0] * counts[1] > _MOST:
        raise command.mistake(f"a patch of {counts[0]} by {counts[1]} fibres", code="L620")
    if kind in ("circ", "circular"):
        numbers = command.reals(5, "yCenter zCenter intRad extRad")
        angles = command.reals(9, "startAng endAng") if len(command.words) > 9 else [0.0, 360.0]
        return material, _rings(counts, (*numbers, *angles))
    if kind in ("quad", "quadr", "quadrilateral"):
        corners = command.reals(5, "yI zI yJ zJ yK zK yL zL")
    elif kind in ("rect", "rectangular"):
        y1, z1, y2, z2 = command.reals(5, "yI zI yJ zJ")
        corners = [y1, z1, y2, z1, y2, z2, y1, z2]
    else:
        raise command.mistake(f"patch {kind[:40]} has no counterpart", "use rect, quad or circ")
    return material, _cells(counts, corners)


def _cells(counts: tuple[int, int], corners: list[float]) -> Iterator[tuple[float, float]]:
    """Centroids and areas of the cells of a quadrilateral I J K L, by its bilinear map."""
    points = [(corners[k], corners[k + 1]) for k in range(0, 8, 2)]

    def at(a: float, b: float) -> tuple[float, float]:
        shares = ((1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b)
        return sum(s * p[0] for s, p in zip(shares, points)), sum(s * p[1] for s, p in zip(shares, points))

    n, m = counts
    for i in range(n):
        for j in range(m):
            cell = [at((i + a) / n, (j + b) / m) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
            twice = moment = 0.0
            for (y1, z1), (y2, z2) in zip(cell, (*cell[1:], cell[0])):
                cross = y1 * z2 - y2 * z1
                twice += cross
                moment += (y1 + y2) * cross
            if twice:
                yield moment / (3.0 * twice), 0.5 * abs(twice)


def _rings(counts: tuple[int, int], numbers: tuple[float, ...]) -> Iterator[tuple[float, float]]:
    """Places and areas of the cells of a ring."""
    y, _, inner, outer, first, last = numbers
    around, across = counts
    turn, step = math.radians(last - first) / around, (outer - inner) / across
    for k in range(across):
        r1, r2 = inner + k * step, inner + (k + 1) * step
        area = 0.5 * abs(turn) * abs(r2 * r2 - r1 * r1)
        if not area:
            continue
        radius = 2.0 / 3.0 * (r2**3 - r1**3) / (r2 * r2 - r1 * r1) * math.sin(0.5 * turn) / (0.5 * turn)
        for i in range(around):
            yield y + radius * math.cos(math.radians(first) + (i + 0.5) * turn), area


def _layer(command: Command) -> Placed:
    """``layer``: straight or circ of bars."""
    kind = command.word(1, "the kind")
    material, count = command.whole(2, "the material"), command.whole(3, "the count")
    area = command.real(4, "the area")
    if not 0 < count <= _MOST:
        raise command.mistake(f"a layer of {count} bars", code="L620")
    if kind in ("straight", "line"):
        y1, _, y2, _ = command.reals(5, "yStart zStart yEnd zEnd")
        spread = max(count - 1, 1)
        offset = 0.5 if count == 1 else 0.0
        return material, iter([(y1 + (y2 - y1) * (k / spread + offset), area) for k in range(count)])
    if kind in ("circ", "circular"):
        y, _, radius = command.reals(5, "yCenter zCenter radius")
        full = len(command.words) < 10
        first, last = (0.0, 360.0 - 360.0 / count) if full else command.reals(8, "startAng endAng")
        step = (last - first) / max(count - 1, 1)
        places = (y + radius * math.cos(math.radians(first + k * step)) for k in range(count))
        return material, iter([(place, area) for place in places])
    raise command.mistake(f"layer {kind[:40]} has no counterpart", "use straight or circ")


_KINDS: Final = {"fiber": _single, "patch": _patch, "layer": _layer}


def _wide_flange(section: Command) -> Iterator[Command]:
    """Patches of a ``WFSection2d``: material, depth, web, flange width and thickness, counts of fibres."""
    material, count_web, count_flange = (section.word(k, "a number") for k in (3, 8, 9))
    d, tw, bf, tf = section.reals(4, "d tw bf tf")
    edges = (-0.5 * d, tf - 0.5 * d, 0.5 * d - tf, 0.5 * d)
    for n, width, low, high in (
        (count_flange, bf, edges[0], edges[1]),
        (count_web, tw, edges[1], edges[2]),
        (count_flange, bf, edges[2], edges[3]),
    ):
        words = (
            "patch",
            "rect",
            material,
            n,
            "1",
            repr(low),
            repr(-0.5 * width),
            repr(high),
            repr(0.5 * width),
        )
        yield Command(words, section.span)
