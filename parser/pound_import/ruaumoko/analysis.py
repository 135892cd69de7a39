"""Sections that follow from the control lines: DAMPING, ANALYSIS, OUTPUT, and the motion or the forces."""

from __future__ import annotations

from typing import Final

from pound_deck.diagnostics import Mistake, mistake
from pound_import.draft import Draft, number, numbers, quoted
from pound_import.ruaumoko import equake
from pound_import.ruaumoko.header import Control
from pound_import.ruaumoko.lines import DataLine, DataLines

STATIC, STATIC_MODAL, EARTHQUAKE, FORCES = range(4)  #: of IPANAL
#: by ICTYPE: the card, and whether a source confirms the code
_DAMPING: Final = {
    0: ("RAYLEIGH", "STIFFNESS=INITIAL", True),
    1: ("RAYLEIGH", "STIFFNESS=TANGENT", False),
    2: ("MODAL", "BEYOND=LINEAR", True),
    3: ("MODAL", "BEYOND=CONSTANT", False),
    6: ("RAYLEIGH", "STIFFNESS=SECANT", True),
}


def kind(control: Control) -> int:
    """Code of the analysis, IPANAL.

    Raises
    ------
    Mistake
        It is none that can be carried over.
    """
    code = control.whole("IPANAL")
    if code not in (STATIC, STATIC_MODAL, EARTHQUAKE, FORCES):
        what = f"is {code}, an analysis that is not carried over"
        raise control.mistake("L604", "IPANAL", what, "0 and 1 static, 2 earthquake, 3 forces")
    return code


def damping(control: Control, draft: Draft) -> None:
    """Add the line of DAMPING.

    Raises
    ------
    Mistake
        Its type is not carried over.
    """
    code, place = control.whole("ICTYPE"), control.place("ICTYPE")
    if code not in _DAMPING:
        what = f"is {code}, a damping that is not carried over"
        raise control.mistake("L604", "ICTYPE", what, "0, 1, 6 Rayleigh; 2, 3 ratios over frequency")
    ratios = control["C1"], control["C2"]
    for name, ratio in zip(("C1", "C2"), ratios):
        if ratio < 0.0:
            what = f"is {number(ratio)}, a damping ratio below zero"
            raise control.mistake("L603", name, what, "C1 and C2 are percents")
    if not any(ratios):
        return
    card, item, known = _DAMPING[code]
    reading = f"ICTYPE {code}: {card} {item}"
    notes = [] if known else [draft.doubt(place, reading)]
    if known and code != 2:
        draft.rest(reading)
    modes = [int(control[name]) for name in ("MODE1", "MODE2")]
    if min(modes) < 1 or modes[0] == modes[1]:
        what = f"is {modes[0]}, and MODE2 behind it is {modes[1]}"
        raise control.mistake("L603", "MODE1", what, "two modes, counted from 1")
    xi = numbers(c / 100.0 for c in ratios)
    draft.add("DAMPING", f"{card} XI={xi} MODES={numbers(modes)} {item}", control.place("C1"), notes)


def runs(control: Control, loaded: bool, draft: Draft) -> None:
    """Add ANALYSIS and OUTPUT."""
    code, place, notes = kind(control), control.place("IPANAL"), list[str]()
    if code != EARTHQUAKE:
        words = {STATIC: "static", STATIC_MODAL: "static and modal", FORCES: "a force history by SHAPE"}
        notes.append(draft.doubt(place, f"IPANAL {code}: {words[code]}"))
    if not control.whole("IPLAS"):
        notes.append(draft.doubt(control.place("IPLAS"), "IPLAS 0: all members stay elastic"))
    if loaded or code in (STATIC, STATIC_MODAL):
        draft.add("ANALYSIS", "STATIC SELF_WEIGHT=NO", place, notes)
        notes = []
    if control["M"] >= 1:
        draft.add("ANALYSIS", f"MODAL {int(control['M'])}", control.place("M"), notes)
        notes = []
    if code in (EARTHQUAKE, FORCES):
        if control["TIME"] <= 0.0:
            raise control.mistake("L603", "TIME", "is not above zero", "the length of the history")
        text = f"HISTORY {number(control['TIME'])} METHOD=NEWMARK DT={number(control['DT'])}"
        draft.add("ANALYSIS", text, control.place("TIME"), notes)
        notes = []
        if control["KPA"] >= 1:
            every = number(int(control["KPA"]) * control["DT"])
            draft.add("OUTPUT", f"EVERY={every}", control.place("KPA"))
    if notes:
        draft.add("ANALYSIS", "", place, notes)


def motions(
    rows: DataLines, control: Control, appended: equake.File, separate: list[equake.File], draft: Draft
) -> None:
    """Add the ground motions of an EQUAKE section.

    Raises
    ------
    Mistake
        See `equake.record`.
    """
    horizontal = rows.next("the line of EQUAKE: " + " ".join(equake.NAMES))
    vertical: DataLine | None = None
    notes: list[str] = []
    if control.whole("IPVERT"):
        vertical = rows.next("the second line of EQUAKE")
        notes.append(draft.doubt(control.place("IPVERT"), "IPVERT: a second line and a second file, for y"))
    if vertical is None:
        behind = equake.Appended(appended, rows.here.line + 1)
        _motion(horizontal, control, behind, separate[0] if separate else None, "", notes, draft)
        return
    if len(separate) < 2:
        text = "IPVERT: a horizontal and a vertical record, each in a file of its own"
        hint = "pound-solve import DECK --record HORIZONTAL --record VERTICAL names them"
        raise mistake("L611", text, horizontal.span, hint)
    nothing = equake.Appended(equake.File("", ""), 1)
    for row, file, direction in zip((horizontal, vertical), separate, ("", " DIRECTION=Y")):
        try:
            _motion(row, control, nothing, file, direction, notes, draft)
        except Mistake as error:  # both files are reported
            error.keep(draft.report)
        notes = []


def _motion(
    row: DataLine,
    control: Control,
    appended: equake.Appended,
    separate: equake.File | None,
    direction: str,
    notes: list[str],
    draft: Draft,
) -> None:
    record = equake.record(row, appended, separate, draft, notes)
    factor = equake.scale(row, control["FACTOR"], record.unit, draft, notes)
    unit = quoted(record.unit) if record.unit and record.unit != "G" else "G"
    scale = f" SCALE={number(factor)}" if factor != 1.0 else ""
    draft.add("EQUAKE", f"RECORD {record.items} UNIT={unit}{scale}{direction}", row.span, notes)


def forces(
    rows: DataLines,
    control: Control,
    shape: list[tuple[DataLine, int, list[float]]],
    appended: equake.File,
    separate: list[equake.File],
    draft: Draft,
) -> None:
    """Add the forces in time that SHAPE distributes over the nodes.

    Raises
    ------
    Mistake
        See `equake.record`.
    """
    row, notes = rows.next("the line of EQUAKE: " + " ".join(equake.NAMES)), list[str]()
    behind = equake.Appended(appended, rows.here.line + 1)
    file = equake.record(row, behind, separate[0] if separate else None, draft, notes).items
    factor = equake.scale(row, control["FACTOR"], None, draft, notes)  # shares of SHAPE have no unit
    notes.append(draft.doubt(row.span, "the force of a node is SHAPE times FACTOR times the record"))
    for line, id_, values in shape:
        components = " ".join(number(factor * x) for x in values)
        draft.add("FORCES", f"RECORD {id_} {components} {file}", line.span, notes)
        notes = []
