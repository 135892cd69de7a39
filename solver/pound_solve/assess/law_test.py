"""Response of a law to a path of deformation, for ``pound-solve loop``.

The specimen is a deck of one spring (or contact), so that its items are read, checked and built as in any
other deck.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from pound_deck.diagnostics import has_errors, hints, render, suggest
from pound_deck.reader import read_text
from pound_deck.schema import Spec
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import Law, NoProgressError, State, transitions
from pound_solve.report.text_plot import svg
from pound_solve.structure.assembly import AssemblyError, assemble
from pound_solve.structure.elements.base import LawSpring
from pound_solve.user_error import UserError

#: start of the specimen's card; default items, and the fields that require them
_CARDS: Final = {
    "hysteresis": ("SPRING RULE", {"KX=1": "", "FX=1": ""}),
    "contact": (
        "CONTACT LAW",
        {"GAP=0": "", "MASSES=2,2": "E", "K=1": "K", "MASSES=1,1": "MODEL", "DIAPHRAGMS=2,1": "MODEL"},
    ),
}
DUCTILITIES: Final = (0.5, 1.0, 2.0, 4.0, 6.0)  #: of the cycles applied to a hysteresis rule
CLOSURES: Final = (1.0, -0.5, 2.0, -0.5)  #: closures beyond the gap applied to a contact
SAMPLES: Final = 32  #: points of a curved branch in a drawing
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)


#: names of the axes
AXES: Final = {"hysteresis": ("deformation", "force"), "contact": ("closure", "contact force")}


class LawTestError(UserError):
    """Raised if a specimen cannot be built or driven."""


@dataclass(frozen=True)
class LoopPoint:
    """A corner of the path: a change of branch, or a turning point of the deformation.

    Attributes
    ----------
    d, f : float
        Deformation and force [F].
    branch : str
        The branch that led there.
    work, stored, lost : float
        Work done on the law so far, the recoverable and the dissipated part [F L].
    turn : bool
    """

    d: float
    f: float
    branch: str
    work: float
    stored: float
    lost: float
    turn: bool


@dataclass(frozen=True)
class Trace:
    """Response of a law to a path: its corners, and the curve between them for drawings."""

    corners: tuple[LoopPoint, ...]
    curve: tuple[tuple[float, float], ...]


def law_of(name: str) -> Spec:
    """Spec of a hysteresis rule or contact law by name or ``family name``, in any case.

    Raises
    ------
    LawTestError
        There is no such law; the message lists the laws.
    """
    known = {family: catalog().family(family) for family in _CARDS}
    *prefix, word = name.upper().split()
    families = [f for f in known if not prefix or f.upper() == prefix[0]]
    specs = [known[f][word] for f in families if word in known[f]]
    if len(specs) == 1:
        return specs[0]
    if specs:
        raise LawTestError(f"{word} is a rule and a contact law: write hysteresis {word} or contact {word}")
    if others := [f for f in catalog().families() if word in catalog().family(f) and not prefix]:
        what = f"{word} is of the family {others[0]}"
        raise LawTestError(f"{what}: only hysteresis rules and contact laws have loops")
    there = "; ".join(f"{f}: {', '.join(known[f])}" for f in families)
    near = suggest(word, [name for f in families for name in known[f]])
    raise LawTestError(f"no law {word}: " + hints(near, f"there are {there}"))


def specimen(spec: Spec, items: Sequence[str] = ()) -> tuple[LawSpring, str]:
    """Build a law from its items; also return these, with added defaults, as text.

    Parameters
    ----------
    spec : Spec
        Of a hysteresis rule or contact law.
    items : sequence of str
        ``NAME=value`` as in a deck; none at all: the law's own `sample`.

    Raises
    ------
    LawTestError
        Items are unknown or contradict each other; the message is that of the deck's reader.
    """
    if spec.impl is None:
        raise LawTestError(f"{spec.name} is a straight line through zero: there is no loop")
    kind, left_out = _CARDS[spec.family]
    written = [" ".join(item.split()) for item in items] or spec.sample.split()
    names = {item.split("=")[0].strip().upper() for item in written}
    additions = [x for x, wanted in left_out.items() if not wanted or spec.field(wanted)]
    card = " ".join([*(x for x in additions if x.split("=")[0] not in names), *written])
    nodes = "NODES\n 1 0 0 FIX=YR\n 2 1 0 FIX=YR\nELEMENTS\n 1 LOOP 1 2\n"
    deck = f"{nodes}PROPS\n LOOP {kind}={spec.name} {card}\nANALYSIS\n STATIC\n"
    model, diagnostics, files = read_text(deck, catalog(), name="loop")
    if model is None or has_errors(diagnostics):
        raise LawTestError(render(diagnostics, files))
    try:
        (spring,) = assemble(model).laws
    except AssemblyError as err:
        raise LawTestError("\n".join(d.message for d in err.diagnostics)) from None
    if spring.law.rigid:
        raise LawTestError(
            f"{spec.name} is rigid: its force does not follow from its closure, there is no loop"
        )
    return spring, card


def protocol(spring: LawSpring) -> list[float]:
    """Deformations of cycles to growing ductilities; closures and openings of a contact.  A side that never
    yields is deformed as far as the other.

    Raises
    ------
    LawTestError
        The spring has no yield deformation on one of its sides.
    """
    if spring.role.collides:
        return [spring.gap + x for x in CLOSURES]
    plus, minus = spring.yields or (0.0, 0.0)
    if plus == 0.0 or minus == 0.0:
        raise LawTestError("without a yield deformation on both sides the path must be given: --path")
    sides = -minus if math.isnan(plus) else plus, -plus if math.isnan(minus) else minus
    return [mu * d for mu in DUCTILITIES for d in sides] + [0.0]


def usual_rate(spring: LawSpring) -> float:
    """Return the speed at which a loop is drawn unless another is given: 1 if the reported force includes
    the law's resistance to the rate, otherwise 0.
    """
    return 1.0 if spring.role.reports_damping else 0.0


def trace(law: Law, path: Sequence[float], rate: float = 0.0) -> Trace:
    """Drive a virgin law from zero deformation along a path.

    Parameters
    ----------
    law : Law
    path : sequence of float
        Turning points of the deformation [L] or [rad].
    rate : float
        Speed of the deformation [L/T], which determines the forces of dashpots; 0: infinitely slow.

    Raises
    ------
    LawTestError
        The law changes branch again and again without moving.
    """
    state, d, drag = law.start(), 0.0, 0.0
    corners = [_point(law, state, d, 0.0, 0.0, False)]
    curve = [(d, corners[0].f)]
    for goal in path:
        if goal == d:
            continue
        v = rate if goal > d else -rate
        try:
            for at, new in _branches(law, state, d, goal, rate):
                if at != d:  # a branch with an immediate transition does not count
                    drag += _drag(law, state, d, at, v)
                    corners.append(_point(law, state, at, v, drag, at == goal))
                    between = np.linspace(d, at, SAMPLES + 1).tolist() if law.curved else [d, at]
                    curve += [(x, law.force(state, x, v)[0]) for x in between]
                state, d = new, at
        except NoProgressError as err:
            raise LawTestError(f"near deformation {d:g} {err}") from None
    return Trace(tuple(corners), tuple(curve))


def _branches(law: Law, state: State, d: float, goal: float, rate: float) -> Iterator[tuple[float, State]]:
    """Yield deformation and state at the end of each branch on the way to `goal`, and at `goal`."""
    for at, after in transitions(law, state, d, goal, rate):
        yield at, after
        state = after
    yield goal, state


def _point(law: Law, state: State, d: float, v: float, drag: float, turn: bool) -> LoopPoint:
    force, stored, lost = law.force(state, d, v)[0], law.stored(state, d), law.dissipated(state, d)
    return LoopPoint(d, force, law.branch(state).name, law.work(state, d) + drag, stored, lost + drag, turn)


def _drag(law: Law, state: State, d0: float, d1: float, v: float) -> float:
    """Work of the dashpot force between two deformations by Gauss points (exact for high powers)."""
    if v == 0.0:
        return 0.0
    half, middle = 0.5 * (d1 - d0), 0.5 * (d0 + d1)
    extra = [
        law.force(state, middle + half * x, v)[0] - law.force(state, middle + half * x)[0] for x in _NODES
    ]
    return half * float(_WEIGHTS @ extra)


def table(points: Sequence[LoopPoint]) -> str:
    """Text of a table of the corners, turning points marked and rounding errors set to zero."""
    heads = ("deformation", "force", "work", "stored", "dissipated")
    columns = np.array([(p.d, p.f, p.work, p.stored, p.lost) for p in points])
    columns[np.abs(columns) < 1e-13 * np.abs(columns).max(axis=0)] = 0.0
    lines = [
        [*heads, "branch", ""],
        *(
            [*(f"{x:.6g}" for x in row), p.branch, "turn" * p.turn]
            for row, p in zip(columns.tolist(), points)
        ),
    ]
    wide = [max(len(line[i]) for line in lines) for i in range(6)]
    return "\n".join(
        "  ".join([*(x.rjust(w) for x, w in zip(line[:5], wide)), line[5].ljust(wide[5]), line[6]]).rstrip()
        for line in lines
    )


def picture(spec: Spec) -> str:
    """SVG of a law's loop with its `sample`, for the manual."""
    spring, items = specimen(spec)
    loop = trace(spring.law, protocol(spring), usual_rate(spring))
    return svg(loop.curve, f"{spec.name} {items}", *AXES[spec.family])
