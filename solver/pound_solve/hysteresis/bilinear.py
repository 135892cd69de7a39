r"""Bilinear with kinematic hardening.

With stiffness :math:`k`, yield forces :math:`F_y^+ > 0 > F_y^-` and post-yield ratio :math:`r` the rule is
a spring :math:`r k` beside an elastic, perfectly plastic spring :math:`(1-r) k` that yields at
:math:`(1-r) F_y^\pm`:

.. math:: f = r k d + (1-r) k (d - d_p), \qquad (1-r) F_y^- \le (1-r) k (d - d_p) \le (1-r) F_y^+

Energy: :math:`\tfrac12 r k d^2 + \tfrac12 (1-r) k (d-d_p)^2` is stored,
:math:`(1-r) F_y^\pm \, \Delta d_p` is lost.

References
----------
Iwan WD (1966), A distributed-element model for hysteresis and its steady-state dynamic response, J. Appl.
Mech. 33(4): 893-900 (the parallel form); Ruaumoko's rule 2.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws import Branch, Exit

State = tuple[
    str, float, float
]  #: branch, plastic deformation d_p (at entry), plastic work so far (at entry)

REVERSAL = {"yielding +": Exit(0.0, -1.0, 0.0), "yielding -": Exit(0.0, 1.0, 0.0)}


@dataclass(frozen=True, slots=True)
class Bilinear:
    """The rule for one component; symbols as at the head of the file."""

    k: float
    fy_plus: float
    fy_minus: float
    r: float = 0.0

    @property
    def slider(self) -> tuple[float, float, float]:
        """Stiffness and yield forces of the elastic, perfectly plastic part."""
        share = 1.0 - self.r
        return share * self.k, share * self.fy_plus, share * self.fy_minus

    def start(self) -> State:
        """Virgin state."""
        return "elastic", 0.0, 0.0

    def branch(self, state: State) -> Branch:
        """Linear piece of `state`."""
        name, dp, _ = state
        ke, plus, minus = self.slider
        if name == "elastic":
            exits = (Exit(ke, 0.0, -ke * dp - plus), Exit(-ke, 0.0, ke * dp + minus))
            return Branch(name, self.k, 0.0, -ke * dp, exits)
        force0 = plus if name == "yielding +" else minus
        return Branch(name, self.r * self.k, 0.0, force0, (REVERSAL[name],))

    def leave(self, state: State, exit_index: int, d: float) -> State:
        """Yield out of the elastic branch, or unload where the motion turns."""
        name, dp, work = state
        if name == "elastic":
            return ("yielding +", "yielding -")[exit_index], dp, work
        return "elastic", self.plastic(state, d), self.dissipated(state, d)

    def plastic(self, state: State, d: float) -> float:
        """Plastic deformation d_p at deformation `d`."""
        name, dp, _ = state
        if name == "elastic":
            return dp
        ke, plus, minus = self.slider
        return d - (plus if name == "yielding +" else minus) / ke

    def stored(self, state: State, d: float) -> float:
        """Recoverable energy."""
        ke = self.slider[0]
        return 0.5 * self.r * self.k * d * d + 0.5 * ke * (d - self.plastic(state, d)) ** 2

    def dissipated(self, state: State, d: float) -> float:
        """Plastic work so far."""
        name, dp, work = state
        _, plus, minus = self.slider
        force = {"elastic": 0.0, "yielding +": plus, "yielding -": minus}[name]
        return work + force * (self.plastic(state, d) - dp)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Bilinear:
    """Rule from a card's values, a stiffness and the two yield forces."""
    return Bilinear(k, fy_plus, fy_minus, values["R"])


SPEC = Spec(
    "hysteresis",
    "BILINEAR",
    "bilinear, kinematic hardening",
    (
        Field(
            "R",
            Kind.REAL,
            "-",
            default=0.0,
            below=1.0,
            doc="post-yield stiffness as a share of the initial",
        ),
    ),
    code=2,
    reference="Iwan 1966; Ruaumoko rule 2",
    impl=build,
)
