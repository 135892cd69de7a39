"""The damping constant of a contact law from its card: given directly, or as the restitution E."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from pound_deck.schema import Field, Kind
from pound_solve.laws.refusal import ItemError

Relation = Callable[[float], float]


class Constant(NamedTuple):
    """A damping constant, the required restitution (NaN: none), the resulting one, and a note."""

    value: float
    e_asked: float
    e_given: float
    note: str


def fields(name: str, doc: str, published: str) -> tuple[Field, Field, Field]:
    """Return the fields of the constant `name`, of E, and of the relation between them."""
    return (
        Field(name, Kind.REAL, "-", default=None, lo=0, doc=f"{doc} ({name} or E)"),
        Field(
            "E",
            Kind.REAL,
            "-",
            default=None,
            above=0,
            hi=1,
            doc=f"coefficient of restitution ({name} or E)",
        ),
        Field(
            "RELATION",
            Kind.WORD,
            default="EXACT",
            words=("EXACT", "PUBLISHED"),
            doc=f"how E becomes {name}: exact, or {published}",
        ),
    )


def damping_item(
    values: Mapping[str, Any], names: tuple[str, ...], reduced_mass: float, free: str = ""
) -> str:
    """Return the name of the single item that the card gives; all items except `free` need masses.

    Raises
    ------
    ValueError
        None or several are given; or there is no mass.
    """
    present = [name for name in names if values[name] is not None]
    if len(present) != 1:
        ways = " or ".join([", ".join(f"as {name}" for name in names[:-1]), f"as {names[-1]}"])
        raise ValueError(
            f"give the damping once: {ways}" + (", not " + " and ".join(present) if present else "")
        )
    if present[0] != free and reduced_mass == 0.0:
        raise ItemError(
            f"{present[0]} needs colliding masses: give the nodes weight, or MASSES", present[0]
        )
    return present[0]


def constant(
    values: Mapping[str, Any], name: str, restitution_of: Relation, exact: Relation, published: Relation
) -> Constant:
    """Return the constant `name` of a law, given directly or computed from E.

    Parameters
    ----------
    values : mapping
        Contains `name`, E and RELATION.
    restitution_of : callable
        Restitution that a constant gives.
    exact, published : callable
        Constant for a restitution.
    """
    if (value := values[name]) is not None:
        return Constant(value, math.nan, restitution_of(value), f"{name} given")
    e, word = values["E"], values["RELATION"]
    value = (published if word == "PUBLISHED" else exact)(e)
    return Constant(value, e, restitution_of(value), f"{word.lower()} relation of E to {name}")


class Dashpot(NamedTuple):
    """A linear dashpot: its coefficient [F T/L], its damping ratio, and the fields of `Constant`."""

    c: float
    xi: float
    e_asked: float
    e_given: float
    note: str


def dashpot(
    values: Mapping[str, Any],
    reduced_mass: float,
    restitution_of: Relation,
    exact: Relation,
    published: Relation,
) -> Dashpot:
    """Return the dashpot of a linear law, given as C, XI or E (see `constant`) with the stiffness K.

    Raises
    ------
    ValueError
        None or several of C, XI, E are given; or XI or E is given but there is no mass.
    """
    critical = 2.0 * math.sqrt(values["K"] * reduced_mass)
    if damping_item(values, ("C", "XI", "E"), reduced_mass, "C") == "C":
        xi = values["C"] / critical if critical else math.inf
        return Dashpot(values["C"], xi, math.nan, restitution_of(xi) if critical else math.nan, "C given")
    ratio = constant(values, "XI", restitution_of, exact, published)
    return Dashpot(ratio.value * critical, *ratio)


def linear_fields(published: str) -> tuple[Field, ...]:
    """Return the fields of a linear spring with a dashpot."""
    relation = fields("XI", "", published)[2]
    which = "(one of C, XI, E)"
    return (
        Field("K", Kind.REAL, "F/L", above=0, words=("ADJACENT",), doc="contact stiffness"),
        Field("C", Kind.REAL, "F*T/L", default=None, lo=0, doc=f"dashpot {which}"),
        Field(
            "XI", Kind.REAL, "-", default=None, lo=0, doc=f"damping ratio on the colliding masses {which}"
        ),
        Field("E", Kind.REAL, "-", default=None, above=0, hi=1, doc=f"coefficient of restitution {which}"),
        relation,
    )
