"""A small catalog for the reader's tests: the shape of the solver's, without its numerics."""

import pytest

from pound_deck.schema import Catalog, Field, Kind, Spec


def make_catalog() -> Catalog:
    real = Kind.REAL
    stiffness = tuple(Field(n, real, "F/L", default=0.0, lo=0, doc=f"stiffness {n}") for n in ("KX", "KY"))
    strength = tuple(
        Field(n, real, "F", default=None, count=(1, 2), doc=f"strength {n}") for n in ("FX", "FY", "MR")
    )
    rule = Field(
        "RULE", Kind.FAMILY, default=("ELASTIC",), family="hysteresis", count=(1, 3), doc="hysteresis"
    )
    return Catalog(
        (
            Spec(
                "element",
                "SPRING",
                "spring",
                (
                    *stiffness,
                    Field("KR", real, "F*L", default=0.0, lo=0),
                    Field("ANGLE", real, "-", default=0.0),
                    *strength,
                    rule,
                ),
                code=1,
            ),
            Spec(
                "element",
                "FRAME",
                "beam or column",
                (
                    Field("E", real, "F/L^2", above=0, doc="Young's modulus"),
                    Field("A", real, "L^2", above=0, doc="area of the section"),
                    Field("I", real, "L^4", default=0.0, lo=0, doc="second moment of area"),
                ),
            ),
            Spec(
                "element",
                "CONTACT",
                "contact",
                (
                    Field("GAP", real, "L", default=0.0, lo=0, doc="opening at rest"),
                    Field("ANGLE", real, "-", default=0.0),
                    Field("LAW", Kind.FAMILY, default="LINEAR", family="contact", doc="contact law"),
                ),
            ),
            Spec("hysteresis", "ELASTIC", "elastic", code=0),
            Spec("hysteresis", "ELASTO_PLASTIC", "elasto-plastic", code=1),
            Spec("hysteresis", "BILINEAR", "bilinear", (Field("R", real, "-", lo=0, below=1),), code=2),
            Spec(
                "contact", "LINEAR", "linear", (Field("K", real, "F/L", above=0, doc="stiffness"),), code=0
            ),
            Spec(
                "contact",
                "KELVIN_VOIGT",
                "Kelvin-Voigt",
                (
                    Field("K", real, "F/L", above=0, doc="stiffness"),
                    Field("E", real, "-", default=None, lo=0, hi=1, doc="restitution"),
                    Field("XI", real, "-", default=None, lo=0),
                    Field("C", real, "F*T/L", default=None, lo=0),
                    Field(
                        "TENSION", Kind.WORD, default="NO", words=("NO", "YES"), codes={"NO": 0, "YES": 1}
                    ),
                ),
                code=1,
            ),
            Spec(
                "damping",
                "RAYLEIGH",
                "Rayleigh",
                (
                    Field("ALPHA", real, "1/T", default=0.0),
                    Field("BETA", real, "T", default=0.0),
                    Field("XI", real, "-", default=None, count=(1, 2), lo=0),
                    Field("NODES", Kind.NODES, default=None),
                    Field("PROPS", Kind.PROPS, default=None),
                ),
            ),
            Spec(
                "motion",
                "RECORD",
                "record",
                (
                    Field("FILE", Kind.TEXT, doc="file of the record"),
                    Field("FORMAT", Kind.FAMILY, default="PEER", family="record"),
                    Field("UNIT", Kind.WORD, default="G", words=("G", "CM/S2"), doc="unit of the samples"),
                    Field("SUPPORTS", Kind.NODES, default=None, doc="nodes that move"),
                ),
            ),
            Spec("record", "PEER", "PEER"),
            Spec(
                "analysis",
                "STATIC",
                "static",
                (Field("GRAVITY", Kind.WORD, default="NO", words=("YES", "NO"), doc="weights press"),),
            ),
            Spec(
                "analysis",
                "MODAL",
                "modes",
                (Field("MODES", Kind.INT, default=None, lo=1, positional=True),),
            ),
            Spec(
                "analysis",
                "HISTORY",
                "time history",
                (
                    Field("T", real, "T", above=0, doc="duration"),
                    Field("METHOD", Kind.FAMILY, default="EXACT", family="method"),
                ),
            ),
            Spec("method", "EXACT", "exact"),
            Spec("method", "NEWMARK", "Newmark", (Field("DT", real, "T", above=0, doc="time step"),)),
        )
    )


@pytest.fixture(scope="session")
def catalog() -> Catalog:
    return make_catalog()
