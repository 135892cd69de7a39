"""The four control lines: analysis, structure, output, iteration.

``IPANAL IFMT IPLAS IPCONM ICTYPE IPVERT INLGEO IPNF IZERO ORTHO IMODE``,
``NNP NMEM NTYPE M MODE1 MODE2 GRAV C1 C2 DT TIME FACTOR``,
``KP KPA KPLOT JOUT DSTORT DFACT XMAX YMAX NLEVEL NUP IRESID KDUMP``,
``MAXIT MAXCIT FTEST WAVEX THETA DXMAX D OMEGA F0``.

Only the values 2 0 1 0 2 0 0 0 0 0 0 are confirmed, by a deck with known results.  The meaning of other
values, except ICTYPE 0 and 6, is recalled from memory.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import Mistake, mistake
from pound_deck.model import Span
from pound_import.draft import Draft, number
from pound_import.ruaumoko.lines import DataItem, DataLine

ANALYSIS: Final = (
    *("IPANAL", "IFMT", "IPLAS", "IPCONM", "ICTYPE", "IPVERT"),
    *("INLGEO", "IPNF", "IZERO", "ORTHO", "IMODE"),
)
STRUCTURE: Final = (
    *("NNP", "NMEM", "NTYPE", "M", "MODE1", "MODE2"),
    *("GRAV", "C1", "C2", "DT", "TIME", "FACTOR"),
)
OUTPUT: Final = (
    *("KP", "KPA", "KPLOT", "JOUT", "DSTORT", "DFACT"),
    *("XMAX", "YMAX", "NLEVEL", "NUP", "IRESID", "KDUMP"),
)
ITERATION: Final = ("MAXIT", "MAXCIT", "FTEST", "WAVEX", "THETA", "DXMAX", "D", "OMEGA", "F0")
_MOST: Final = 100_000  #: nodes, members or property sets
_GRAVITIES: Final = (  # limits, and the usual units
    (9.7, 9.9, "kN m s"),
    (32.0, 32.4, "kip ft s"),
    (385.0, 388.0, "kip in s"),
    (970.0, 990.0, "kN cm s"),
    (9700.0, 9900.0, "kN mm s"),
)


@dataclass(frozen=True, slots=True)
class Control:
    """Values of the control lines by the names of their items, and the items."""

    values: dict[str, float]
    items: dict[str, DataItem]

    def __getitem__(self, name: str) -> float:
        return self.values[name]

    def whole(self, name: str) -> int:
        """Value of a code or a count as a whole number."""
        return int(self.values[name])

    def place(self, name: str) -> Span:
        """Place of an item."""
        return self.items[name].span

    def mistake(self, code: str, name: str, what: str, hint: str) -> Mistake:
        """Make a Mistake about an item; `what` begins with a verb."""
        return self.items[name].mistake(code, name, what, hint)


def read(rows: Sequence[DataLine], here: Span) -> Control:
    """Items of the control lines; those that are left out at the end of a line are zero.

    Raises
    ------
    Mistake
        A line is missing, is cut before an item that is needed, or holds something else.
    """
    values: dict[str, float] = {}
    items: dict[str, DataItem] = {}
    kinds = ((ANALYSIS, 5), (STRUCTURE, 11), (OUTPUT, 9), (ITERATION, 3))
    for k, (names, least) in enumerate(kinds):
        if k >= len(rows):
            raise mistake("L602", f"there is no line of {names[0]} {names[1]} ...", here, "add the line")
        row = rows[k]
        whole = names is ANALYSIS
        values |= zip(names, row.wholes(names, least) if whole else row.reals(names, least))
        items |= {name: row.item(n) for n, name in enumerate(names)}
    if "FACTOR" in values and len(rows[1].items) < len(STRUCTURE):
        values["FACTOR"] = 1.0
    for name in ("NNP", "NMEM", "NTYPE"):
        count = values[name]
        if count != int(count) or not 1 <= count <= _MOST:
            what = f"is {number(count)}, not a count from 1 to {_MOST}"
            raise items[name].mistake("L603", name, what, f"the line is {' '.join(STRUCTURE)}")
    for name in ("GRAV", "DT"):
        if values[name] <= 0.0:
            what = f"is {number(values[name])}, not above zero"
            raise items[name].mistake("L603", name, what, f"the line is {' '.join(STRUCTURE)}")
    return Control(values, items)


def write(control: Control, draft: Draft) -> None:
    """Add the cards that belong to no section."""
    _fixed_format(control)
    units = next((u for low, high, u in _GRAVITIES if low <= control["GRAV"] <= high), "")
    if units:
        note = "the old deck names no units: these are usual with its gravity; nothing is converted"
        draft.add("", f"UNITS {units}", control.place("GRAV"), [note])
    else:
        draft.add("", "UNITS F L s", control.place("GRAV"), ["the old deck names no units"])
    draft.add("", f"GRAVITY {number(control['GRAV'])}", control.place("GRAV"))
    _mass(control, draft)
    _geometry(control, draft)
    _unknown(control, draft)


def _fixed_format(control: Control) -> None:
    if control.whole("IFMT"):
        what = "is not 0: items in fixed columns"
        raise control.mistake("L604", "IFMT", what, "write the items with blanks between, and IFMT 0")


def _mass(control: Control, draft: Draft) -> None:
    code, place = control.whole("IPCONM"), control.place("IPCONM")
    if code not in (0, 1, 2):
        what = f"is {code}, which is not known"
        raise control.mistake("L604", "IPCONM", what, "0 lumped, 1 diagonal, 2 consistent")
    notes = []
    if code == 1:
        notes.append(draft.doubt(place, "IPCONM 1: lumped mass; give rotational inertia in WEIGHTS (WR)"))
    if code == 2:
        notes.append(draft.doubt(place, "IPCONM 2: consistent mass of members"))
    draft.add("", "MASS CONSISTENT" if code == 2 else "MASS LUMPED", place, notes)


def _geometry(control: Control, draft: Draft) -> None:
    code, place = control.whole("INLGEO"), control.place("INLGEO")
    words = {0: "SMALL", 1: "PDELTA", 2: "LARGE"}
    if code not in words:
        what = f"is {code}, which is not known"
        raise control.mistake("L604", "INLGEO", what, "0 small, 1 P-Delta, 2 large displacements")
    notes = [draft.doubt(place, f"INLGEO {code}: GEOMETRY {words[code]}")] if code else []
    draft.add("", f"GEOMETRY {words[code]}", place, notes)


def _unknown(control: Control, draft: Draft) -> None:
    """Warn of items that change results but whose meaning is not known."""
    for name in ("IPNF", "IZERO", "ORTHO", "IMODE", "WAVEX", "DXMAX", "D", "OMEGA", "F0"):
        if control[name]:
            note = draft.lose(control.place(name), f"{name} {number(control[name])}")
            draft.add("", "", control.place(name), [note])
