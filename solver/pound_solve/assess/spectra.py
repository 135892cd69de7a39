"""Motions for ``pound-solve spectrum``: of records, of decks, of nodes in a results file.

A record is read by a card of a small deck, so that items and messages are those of a RECORD card.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Units
from pound_solve.driver import record_card
from pound_solve.driver.prepare import ground
from pound_solve.driver.reading import ReadDeck
from pound_solve.driver.request import Request
from pound_solve.loading.piecewise import Piecewise
from pound_solve.results import Results
from pound_solve.user_error import UserError

SAMPLES: Final = 10  #: stored accelerations in the shortest period, below which they are too coarse
WAYS: Final = MappingProxyType({"X": "X", "Y": "Y", "R": "R (rad)"})  #: names of directions


class SpectrumError(UserError):
    """Raised if a source has no motion; the message states why."""


@dataclass(frozen=True)
class AccelerationSource:
    """Accelerations of one file.

    Attributes
    ----------
    units : Units
    accelerations : mapping of str to Piecewise, [L/T^2]
        By their names.
    warnings : sequence of Diagnostic
    files : mapping of str to str
        Texts to which the warnings refer.
    """

    units: Units
    accelerations: Mapping[str, Piecewise]
    warnings: Sequence[Diagnostic] = ()
    files: Mapping[str, str] = field(default_factory=dict)


def of_record(name: str, items: Sequence[str] = (), folders: Sequence[Path] = ()) -> AccelerationSource:
    """The acceleration of a record file or a known record, in kN, m and s.

    Parameters
    ----------
    name : str
        FILE of a RECORD card.
    items : sequence of str
        ``NAME=value``, the other items of the card.
    folders : sequence of Path
        Folders searched for it, after the working folder.

    Raises
    ------
    DeckError
        The record cannot be read, or the card has no such item.
    """
    card = ReadDeck(*record_card.read(name, items, "spectrum"))
    source = _of_motions(Request("spectrum", records=tuple(folders)), card)
    (acceleration,) = source.accelerations.values()
    title = " ".join([Path(name).name, *items])
    return AccelerationSource(source.units, {title: acceleration}, source.warnings, source.files)


def of_deck(request: Request) -> AccelerationSource:
    """The motions of the EQUAKE cards of a deck, a wave as one for each place.

    Raises
    ------
    DeckError
        The deck or a record has mistakes.
    SpectrumError
        The deck has no motion.
    OSError
        The deck cannot be read.
    """
    source = _of_motions(request)
    if not source.accelerations:
        raise SpectrumError(f"{request.deck} has no motion under EQUAKE")
    return source


def _of_motions(request: Request, deck: ReadDeck | None = None) -> AccelerationSource:
    """Motions of a deck, see `prepare.ground`."""
    base = ground(request, deck)
    stem = Path(request.deck).stem
    names = (f"{stem}: {n} {m.info['name']} {WAYS[m.direction]}" for n, m in enumerate(base.motions, 1))
    series = {name: m.acceleration for name, m in zip(names, base.motions)}
    return AccelerationSource(
        base.model.units, series, [d for d in base.diagnostics if d.code.startswith("R")], base.files
    )


def of_nodes(results: Results, nodes: Sequence[int], direction: str = "X") -> AccelerationSource:
    """Stored absolute accelerations of nodes, straight lines between the output times and
    the instants of close-ups.

    Parameters
    ----------
    results : Results
    nodes : sequence of int
    direction : str
        ``X``, ``Y`` or ``R``.

    Raises
    ------
    SpectrumError
        The file has no history of accelerations, or none of a node.
    """
    if "node/a" not in results.histories or len(results.time) < 2:
        raise SpectrumError(f"{results.path} holds no accelerations of nodes: its deck needs a HISTORY")
    stored = results.attributes("node/a")["nodes"]
    for node in nodes:
        if node not in stored:
            there = ", ".join(map(str, stored[:20])) + (", ..." if len(stored) > 20 else "")
            raise SpectrumError(
                f"{results.path} holds no accelerations of node {node}: OUTPUT NODES of the deck chooses "
                f"what is stored; there are {there}"
            )
    t, a = results.course("node/a")
    a = a[:, :, "XYR".index(direction)]
    accelerations = {
        f"{results.path.with_suffix('')} node {node} {WAYS[direction]}": Piecewise.from_samples(
            t, a[:, stored.index(node)]
        )
        for node in nodes
    }
    return AccelerationSource(results.units, accelerations)


def coarse(source: AccelerationSource, shortest: float) -> str:
    """Warning if accelerations are stored too seldom for the shortest period [T]; else empty."""
    step = max(float(np.diff(a.breaks).max()) for a in source.accelerations.values())
    if step * SAMPLES <= shortest * (1.0 + 1e-9):
        return ""
    time = source.units.time
    return (
        f"accelerations are stored every {step:.4g} {time}, and short peaks between are lost: "
        f"spectra below {SAMPLES * step:.4g} {time} are coarse; for {shortest:.4g} {time} run the deck "
        f"with OUTPUT EVERY={shortest / SAMPLES:.4g}"
    )
