"""Tables by their effect: those that are read, those without effect, and others, which are lost."""

from __future__ import annotations

from typing import Final

from pound_import.draft import Draft
from pound_import.sap2000.constraints import KINDS, OTHERS
from pound_import.sap2000.springs import READERS
from pound_import.sap2000.tables import SapTables

READ: Final = frozenset(
    (
        "ACTIVE DEGREES OF FREEDOM",
        "CASE - DIRECT HISTORY 1 - GENERAL",
        "CASE - DIRECT HISTORY 2 - LOAD ASSIGNMENTS",
        "CASE - DIRECT HISTORY 3 - PROPORTIONAL DAMPING",
        "CASE - DIRECT HISTORY 5 - NONLINEAR PARAMETERS",
        "CASE - MODAL 1 - GENERAL",
        "CASE - MODAL HISTORY 1 - GENERAL",
        "CASE - MODAL HISTORY 2 - LOAD ASSIGNMENTS",
        "CASE - STATIC 1 - LOAD ASSIGNMENTS",
        "CASE - STATIC 4 - NONLINEAR PARAMETERS",
        "COMBINATION DEFINITIONS",
        "CONNECTIVITY - FRAME",
        "CONNECTIVITY - LINK",
        *(f"CONSTRAINT DEFINITIONS - {kind}" for kind in (*KINDS, *OTHERS)),
        "FRAME ADDED MASS ASSIGNMENTS",
        "FRAME AUTO MESH ASSIGNMENTS",
        "FRAME INSERTION POINT ASSIGNMENTS",
        "FRAME LOADS - DISTRIBUTED",
        "FRAME LOADS - GRAVITY",
        "FRAME LOADS - POINT",
        "FRAME LOCAL AXES ASSIGNMENTS 1 - TYPICAL",
        "FRAME OFFSET ALONG LENGTH ASSIGNMENTS",
        "FRAME PROPERTY MODIFIERS",
        "FRAME RELEASE ASSIGNMENTS 1 - GENERAL",
        "FRAME RELEASE ASSIGNMENTS 2 - PARTIAL FIXITY",
        "FRAME SECTION ASSIGNMENTS",
        "FRAME SECTION PROPERTIES 01 - GENERAL",
        "FRAME TENSION AND COMPRESSION LIMITS",
        "FUNCTION - TIME HISTORY - USER",
        "JOINT ADDED MASS ASSIGNMENTS",
        "JOINT CONSTRAINT ASSIGNMENTS",
        "JOINT COORDINATES",
        "JOINT LOADS - FORCE",
        "JOINT LOCAL AXES ASSIGNMENTS 1 - TYPICAL",
        "JOINT RESTRAINT ASSIGNMENTS",
        "JOINT SPRING ASSIGNMENTS 1 - UNCOUPLED",
        "LINK LOCAL AXES ASSIGNMENTS 1 - TYPICAL",
        "LINK PROPERTY ASSIGNMENTS",
        "LINK PROPERTY DEFINITIONS 01 - GENERAL",
        *(f"LINK PROPERTY DEFINITIONS {end}" for end in READERS),
        "LOAD CASE DEFINITIONS",
        "LOAD PATTERN DEFINITIONS",
        "MASS SOURCE",
        "MASSES 1 - MASS SOURCE",
        "MATERIAL PROPERTIES 02 - BASIC MECHANICAL PROPERTIES",
        "PROGRAM CONTROL",
    )
)
#: beginnings of names of tables of the display, of design, of lists to choose from, of cases and functions
#: that `analysis` takes or leaves by their types, and of results
_WITHOUT: Final = (
    *("ANALYSIS OPTIONS", "AREA SECTION PROPERT", "ASSEMBLED ", "AUTO ", "BASE REACTIONS", "CABLE SECTION"),
    *("CASE - ", "COORDINATE SYSTEMS", "DATABASE ", "ELEMENT ", "FRAME DESIGN"),
    *(
        "FRAME LOAD TRANSFER",
        "FRAME OUTPUT STATION",
        "FRAME SECTION PROPERTIES",
        "FUNCTION - ",
        "GENERALIZED ",
    ),
    *(
        "GRID LINES",
        "GROUPS ",
        "HINGES DEF ",
        "JOINT ACCELERATIONS",
        "JOINT DISPLACEMENTS",
        "JOINT PATTERN",
    ),
    *(
        "JOINT REACTIONS",
        "JOINT VELOCITIES",
        "LINK PROPERTY DEFINITIONS ",
        "MATERIAL ",
        "MATERIAL PROPERTIES",
    ),
    *("MODAL ", "NAMED ", "OBJECTS AND ELEMENTS", "OPTIONS ", "OVERWRITES ", "PREFERENCES ", "PROJECT "),
    *("REBAR ", "RESPONSE SPECTRUM", "SECTION DESIGNER", "SELECTION", "SOLID PROPERTY", "TENDON SECTION"),
)


_REMEDIES: Final = {
    "AREA ": "add the loads and the mass of areas to nodes and members",
    "CONNECTIVITY - AREA": "add the loads and the mass of areas to nodes and members",
    "FRAME HINGE ": "add RULE, MI, MJ and LP to the property sets of frames",
}


def others(tables: SapTables, draft: Draft) -> None:
    """Name the tables that are not read and may have an effect."""
    for name, place in tables.heads.items():
        if name not in READ and not name.startswith(_WITHOUT):
            matching = (remedy for start, remedy in _REMEDIES.items() if name.startswith(start))
            remedy = next(matching, "add what it holds to the new deck by hand")
            draft.add("", "", place, [draft.lose(place, f"the table {name[:80]}", remedy)])
