"""Analyses that the cases of the model ask for: static, modal, a history under ground accelerations."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from pound_deck.diagnostics import mistake
from pound_import.draft import Draft, number
from pound_import.sap2000.numbering import computed
from pound_import.sap2000.patterns import StaticLoad
from pound_import.sap2000.planes import SapPlane
from pound_import.sap2000.tables import MOST, SapRow, SapTables

_MODAL: Final = "LINMODAL"
#: types of cases with a history, and the names of their tables
_HISTORIES: Final = {
    "LINMODHIST": "CASE - MODAL HISTORY",
    "NONMODHIST": "CASE - MODAL HISTORY",
    "LINDIRHIST": "CASE - DIRECT HISTORY",
    "NONDIRHIST": "CASE - DIRECT HISTORY",
}
_GEOMETRIES: Final = {"NONE": "", "P-DELTA": "PDELTA", "LARGE DISPL": "LARGE", "LARGE": "LARGE"}
_FUNCTIONS: Final = "FUNCTION - TIME HISTORY - "
_VALUES: Final = _FUNCTIONS + "USER"
_MOST_STEPS: Final = 10_000_000
_MOST_MODES: Final = 100_000


def write(
    tables: SapTables,
    run: Mapping[str, SapRow],
    static: StaticLoad,
    plane: SapPlane,
    has_mass: bool,
    draft: Draft,
) -> None:
    """Add GEOMETRY, DAMPING, EQUAKE, ANALYSIS and OUTPUT.

    Parameters
    ----------
    tables : SapTables
    run : mapping of str to SapRow
        Cases that are run, by name.
    static : StaticLoad
    plane : SapPlane
    has_mass : bool
        Modes and histories need mass.
    draft : Draft
    """
    dynamic = [name for name, row in run.items() if row.word("Type") in (_MODAL, *_HISTORIES)]
    if dynamic and not has_mass:
        place = run[dynamic[0]].span
        what = f"cases without mass in the plane: {', '.join(name[:40] for name in dynamic[:10])}"
        draft.add("ANALYSIS", "", place, [draft.lose(place, what, "add WEIGHTS and the analysis")])
        dynamic = []
    histories = [name for name in dynamic if run[name].word("Type") in _HISTORIES]
    if static.factors or not dynamic:
        draft.add("ANALYSIS", "STATIC SELF_WEIGHT=NO", static.span)
    _geometry(tables, [static.case, *histories[:1]], draft)
    for name in [x for x in dynamic if x not in histories][:1]:
        with draft.keeping():
            _modes(tables, name, run[name], draft)
    for name in histories[:1]:
        with draft.keeping():
            _history(tables, run[name], static, plane, draft)
    for name in histories[1:]:
        note = draft.lose(run[name].span, f"a further history, the case {name[:40]}", "make a deck for it")
        draft.add("ANALYSIS", "", run[name].span, [note])


def _geometry(tables: SapTables, cases: list[str], draft: Draft) -> None:
    """Add GEOMETRY where one of the cases has geometric nonlinearity."""
    for table in (
        "CASE - STATIC 4 - NONLINEAR PARAMETERS",
        "CASE - DIRECT HISTORY 5 - NONLINEAR PARAMETERS",
    ):
        for row in tables[table]:
            key = row.key("GeoNonLin", "GeoNonL")
            word = _GEOMETRIES.get(
                row.word(key, "NONE").replace("LARGE DISPLACEMENT", "LARGE DISPL"), "PDELTA"
            )
            if word and row.get("Case") in cases:
                note = draft.doubt(row.place(key), f"{row.get(key)[:40]}: GEOMETRY {word}")
                draft.add("", f"GEOMETRY {word}", row.place(key), [note])
                return


def _row_of(tables: SapTables, table: str, case: str) -> SapRow | None:
    return next((row for row in tables[table] if row.get("Case") == case), None)


def _modes(tables: SapTables, case: str, defined: SapRow, draft: Draft) -> None:
    row = _row_of(tables, "CASE - MODAL 1 - GENERAL", case)
    modes = row.count("MaxNumModes", 12, _MOST_MODES) if row else 12
    place = row.span if row else defined.span
    draft.add("ANALYSIS", f"MODAL {max(modes, 1)}", place)


def _history(tables: SapTables, defined: SapRow, static: StaticLoad, plane: SapPlane, draft: Draft) -> None:
    """Add a history.

    Raises
    ------
    Mistake
        It has no steps, or its function is not known.
    """
    case, table = defined.text("Case"), _HISTORIES[defined.word("Type")]
    row = _row_of(tables, f"{table} 1 - GENERAL", case)
    if row is None:
        what = f"case {case[:40]} has no row in {table} 1 - GENERAL"
        raise mistake("L644", what, defined.span, "export all tables of load cases")
    steps, step = row.count("OutSteps", 0, _MOST_STEPS), row.real("StepSize")
    if not steps or step <= 0.0:
        raise mistake(
            "L643", f"case {case[:40]} has no steps", row.span, "OutSteps and StepSize above zero"
        )
    motions = sum(
        _motion(tables, load, plane, draft)
        for load in tables[f"{table} 2 - LOAD ASSIGNMENTS"]
        if load.get("Case") == case
    )
    if not motions:
        what = f"the case {case[:40]}, which no acceleration in the plane moves"
        draft.add("ANALYSIS", "", row.span, [draft.lose(row.span, what, "add EQUAKE and HISTORY")])
        return
    _damping(tables, table, case, row, draft)
    notes = ["the steps are chosen by the method: METHOD=NEWMARK DT= takes those of a model"]
    if static.factors and defined.word("InitialCond", "ZERO") == "ZERO":
        notes.append(draft.doubt(defined.span, "the history starts from the static state"))
    draft.add("ANALYSIS", f"HISTORY {computed(steps * step)}", row.span, notes)
    draft.add("OUTPUT", f"EVERY={number(step)}", row.place("StepSize"))


def _motion(tables: SapTables, row: SapRow, plane: SapPlane, draft: Draft) -> bool:
    """Add a ground acceleration; return whether one acts in the plane, even if its function is lost."""
    name = row.word("LoadName").removeprefix("ACCEL").strip()
    if row.word("LoadType") not in ("ACCEL", "ACCELERATION") or name not in ("U1", "U2", "U3"):
        what = f"load {row.get('LoadName')[:40]} of a history: no acceleration along an axis"
        draft.add("EQUAKE", "", row.span, [draft.lose(row.span, what, "FORCES act in time")])
        return False
    axis = int(name[1]) - 1
    if axis == plane.normal:
        draft.add(
            "EQUAKE", "", row.span, [draft.lose(row.span, f"{name}: acceleration out of the plane", "")]
        )
        return False
    if row.real("Angle", 0.0):
        what = "an acceleration at an angle to the axes"
        draft.add("EQUAKE", "", row.span, [draft.lose(row.span, what, "correct SCALE")])
    points = _function(tables, row)
    if not points:
        what = f"function {row.get('Function')[:40]}, whose values are not in the file"
        remedy = "add RECORD FILE= under EQUAKE, with the DIRECTION and SCALE of the load"
        draft.add("EQUAKE", "", row.span, [draft.lose(row.span, what, remedy)])
        return True
    scale = row.real(row.key("TransAccSF", "LoadSF"), 1.0)
    items = (
        f"{f' SCALE={number(scale)}' if scale != 1.0 else ''}{' DIRECTION=Y' if axis == plane.up else ''}"
    )
    draft.add("EQUAKE", f"TABLE POINTS={','.join(map(computed, points))}{items}", row.span)
    return True


def _function(tables: SapTables, row: SapRow) -> list[float]:
    """Times and values of the function of a load, one after the other; empty where they are in a table
    that is not read, such as that of functions from files.

    Raises
    ------
    Mistake
        There is no such function, or its times decrease.
    """
    name = row.text("Function")
    factor, arrival = row.real("TimeFactor", 1.0), row.real("ArrivalTime", 0.0)
    points: list[float] = []
    for line in tables[_VALUES]:
        if line.get("Name") == name:
            time = arrival + factor * line.real("Time")
            if abs(time) > MOST or (points and time < points[-2]):
                raise mistake(
                    "L643", f"function {name[:40]}: Time decreases", line.place("Time"), "ascending"
                )
            points += [time, line.real("Value")]
    if not points and any(x.startswith(_FUNCTIONS) and x != _VALUES for x in tables.heads):
        return points
    if len(points) < 4:
        what = f"function {name[:40]} has no values in {_VALUES}"
        raise mistake("L646", what, row.place("Function"), "convert it to user values, or add a RECORD")
    return points


def _damping(tables: SapTables, table: str, case: str, general: SapRow, draft: Draft) -> None:
    """Add the damping of a history: a ratio of all modes, or proportional to mass and stiffness."""
    ratio = general.real("ConstDamp", 0.0)
    if ratio > 0.0:
        draft.add("DAMPING", f"MODAL XI={number(ratio)}", general.place("ConstDamp"))
    row = _row_of(tables, f"{table} 3 - PROPORTIONAL DAMPING", case)
    if row:
        mass, stiff = row.real("MassCoeff", 0.0), row.real("StiffCoeff", 0.0)
        if mass or stiff:
            draft.add("DAMPING", f"RAYLEIGH ALPHA={number(mass)} BETA={number(stiff)}", row.span)
    others = [name for name in tables.heads if name.startswith(f"{table} 3") and "PROPORTIONAL" not in name]
    if ratio <= 0.0 and others:
        place = tables.heads[others[0]]
        draft.add("DAMPING", "", place, [draft.lose(place, f"the table {others[0]}", "add DAMPING")])
