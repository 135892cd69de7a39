"""A results file with made-up numbers: the samples of all tables and histories."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from output.sample_layouts import LAYOUTS, NODES
from output.sample_rows import ROWS
from pound_deck.model import Units
from pound_solve import __version__
from pound_solve.results import Writer
from pound_solve.results.contents import HISTORIES, TABLES
from pound_solve.results.schema import Layout

__all__ = ("DECK", "NODES", "TITLE", "UNITS", "block", "layout", "rows", "write")

UNITS = Units("kN", "m", "s", stated=True)
TITLE = "Two 2-storey buildings, 20 axial elements per diaphragm – gap 8 mm, ξ = 5 %"
DECK = "TITLE Zwei Gebäude\nUNITS kN m s\nNODES\n   1  0  0  FIX=XYR   ! Stütze\n"


def rows() -> dict[str, list[tuple[Any, ...]]]:
    """Rows of every table."""
    return {name: list(ROWS[name]) for name in TABLES}


def layout() -> Layout:
    """Layout of every history."""
    return {name: LAYOUTS[name] for name in HISTORIES if name != "time"}


def block(start: int, count: int) -> dict[str, np.ndarray]:
    """Histories at `count` instants 0.01 s apart; every number tells where it stands."""
    time = 0.01 * np.arange(start, start + count)
    out = {"time": time}
    for name, (shape, _) in layout().items():
        out[name] = time.reshape(-1, *([1] * len(shape))) + np.arange(math.prod(shape)).reshape(shape)
    return out


def write(path: Path, *, status: str = "done", message: str = "", blocks: int = 3) -> Path:
    """Write the whole sample."""
    with Writer(path, title=TITLE, units=UNITS, program_version=__version__) as writer:
        writer.text("decks/two buildings.inp", DECK)
        writer.start_history(layout())
        for number in range(blocks):
            writer.append(block(number * 100, 100))
        for name, table in rows().items():
            writer.table(name, table, "Accelerations are absolute." if name == "node_envelope" else None)
        if status != "running":
            writer.finish(status, message)
    return path
