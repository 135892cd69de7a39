"""Models of SAP2000 written for the tests; those of `sap2000/` are CSI's verification examples."""

from pathlib import Path

FOLDER = Path(__file__).parent / "sap2000"
#: examples 1-018 (A: hinge and roller) and 1-022 of the Software Verification manual of SAP2000
PORTAL, SEVEN_STOREYS = (
    (FOLDER / f"{name}.s2k").read_text("utf-8") for name in ("portal", "seven_storeys")
)
#: two frames with a gap between them, and a row of every table that is read
EVERYTHING = (FOLDER / "everything.s2k").read_text("utf-8")

#: the portal with a second, empty load pattern
_DEAD = "   LoadPat=DEAD   DesignType=Dead   SelfWtMult=0\n"
TWO_PATTERNS = PORTAL.replace("FLOOR", "DEAD").replace(_DEAD, _DEAD + "   LoadPat=LIVE   SelfWtMult=0\n")


def table(name, *rows):
    """Text of a table."""
    return "\n".join([f'TABLE:  "{name}"', *(f"   {row}" for row in rows), "", ""])


def bathe_and_wilson():
    """Example 1-021: ten bays, nine storeys; 3 units of mass per length are added to all frames."""
    at = {(c, k): 10 * c + k + 1 for c in range(11) for k in range(10)}
    columns = [(at[c, k], at[c, k + 1]) for c in range(11) for k in range(9)]
    beams = [(at[c, k], at[c + 1, k]) for k in range(1, 10) for c in range(10)]
    bars = list(enumerate(columns + beams, 1))
    fixed = "   ".join(f"{c}{k}=Yes" for c in "UR" for k in (1, 2, 3))
    tables = (
        ("PROGRAM CONTROL", 'CurrUnits="Kip, ft, F"'),
        ("JOINT COORDINATES", *(f"Joint={n}   X={20 * c}   Y=0   Z={10 * k}" for (c, k), n in at.items())),
        ("JOINT RESTRAINT ASSIGNMENTS", *(f"Joint={at[c, 0]}   {fixed}" for c in range(11))),
        ("MATERIAL PROPERTIES 02 - BASIC MECHANICAL PROPERTIES", "Material=M   E1=432000   UnitMass=0"),
        ("FRAME SECTION PROPERTIES 01 - GENERAL", "SectionName=S   Material=M   Area=3   I33=1   AS2=0"),
        ("CONNECTIVITY - FRAME", *(f"Frame={n}   JointI={i}   JointJ={j}" for n, (i, j) in bars)),
        ("FRAME SECTION ASSIGNMENTS", *(f"Frame={n}   AnalSect=S" for n, _ in bars)),
        ("FRAME ADDED MASS ASSIGNMENTS", *(f"Frame={n}   MassPerLen=3" for n, _ in bars)),
        ("LOAD CASE DEFINITIONS", "Case=MODAL   Type=LinModal"),
        ("CASE - MODAL 1 - GENERAL", "Case=MODAL   MaxNumModes=3"),
    )
    return "".join(table(*x) for x in tables) + "END TABLE DATA\n"


def replaced(text, name, *rows):
    """The text with another table of that name, or with one more."""
    head = f'TABLE:  "{name}"'
    before, found, after = text.partition(head)
    if not found:
        before, _, _ = text.partition("END TABLE DATA")
        return f"{before}{table(name, *rows)}END TABLE DATA\n"
    _, _, rest = after.partition("\nTABLE:")
    return f"{before}{table(name, *rows)}TABLE:{rest}" if rest else f"{before}{table(name, *rows)}"
