"""Sections that follow from the control lines: DAMPING, ANALYSIS, OUTPUT, and the motion or the forces."""

from __future__ import annotations

from typing import Final

from pound_deck.diagnostics import mistake
from pound_import.draft import Draft, number, numbers
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
        text = f"IPANAL {code}: an analysis that is not carried over"
        raise mistake("L604", text, control.place("IPANAL"), "0 and 1 static, 2 earthquake, 3 forces")
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
        text = f"ICTYPE {code}: a damping that is not carried over"
        raise mistake("L604", text, place, "0, 1, 6 Rayleigh; 2, 3 ratios over frequency")
    ratios = control["C1"], control["C2"]
    if min(ratios) < 0.0:
        raise mistake(
            "L603", "a damping ratio is below zero", control.place("C1"), "C1 and C2 are percents"
        )
    if not any(ratios):
        return
    card, item, known = _DAMPING[code]
    reading = f"ICTYPE {code}: {card} {item}"
    notes = [] if known else [draft.doubt(place, reading)]
    if known and code != 2:
        draft.rest(reading)
    modes = [int(control[name]) for name in ("MODE1", "MODE2")]
    if min(modes) < 1 or modes[0] == modes[1]:
        text = f"MODE1 and MODE2 are {modes[0]} and {modes[1]}"
        raise mistake("L603", text, control.place("MODE1"), "two modes, counted from 1")
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
            raise mistake(
                "L603", "TIME is not above zero", control.place("TIME"), "the length of the history"
            )
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
    behind = equake.Appended(appended, rows.here.line + 1)
    if vertical is None:
        _motion(horizontal, control, behind, separate[:1], "", notes, draft)
    else:
        nothing = equake.Appended(equake.File("", ""), 1)
        _motion(horizontal, control, nothing, separate[:1], "", notes, draft)
        _motion(vertical, control, nothing, separate[1:], " DIRECTION=Y", [], draft)


def _motion(
    row: DataLine,
    control: Control,
    appended: equake.Appended,
    separate: list[equake.File],
    direction: str,
    notes: list[str],
    draft: Draft,
) -> None:
    file = equake.record(row, appended, separate[0] if separate else None, draft, notes)
    factor = equake.scale(row, control["FACTOR"], draft)
    scale = f" SCALE={number(factor)}" if factor != 1.0 else ""
    draft.add("EQUAKE", f"RECORD {file} UNIT=G{scale}{direction}", row.span, notes)


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
    file = equake.record(row, behind, separate[0] if separate else None, draft, notes)
    factor = equake.scale(row, control["FACTOR"], draft)
    notes.append(draft.doubt(row.span, "the force of a node is SHAPE times FACTOR times the record"))
    for line, id_, values in shape:
        components = " ".join(number(factor * x) for x in values)
        draft.add("FORCES", f"RECORD {id_} {components} {file}", line.span, notes)
        notes = []
