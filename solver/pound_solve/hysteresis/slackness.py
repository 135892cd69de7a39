r"""Bilinear with slackness: no force inside a gap, bilinear outside it.

The spring takes hold at :math:`d = g^+` (and at :math:`g^- \le 0`).  On the positive side

.. math:: f = k (d - g^+ - p^+), \qquad f \le F_y^+ + H p^+, \qquad H = \frac{k r}{1 - r}

where :math:`p^+` is the plastic deformation of that side, and likewise on the negative side.
With GROW=YES (braces: the slack grows by the plastic deformation) each side keeps its own :math:`p`;
with GROW=NO the whole slack zone moves with one common :math:`p` and hardening is kinematic:
after a large :math:`p` the other side's yield force :math:`F_y^- + H p` lies above zero,
and the spring yields back before it lets go.

References
----------
Ruaumoko's rule 5 (the shape; written for slender cross braces).  The choice of H, which makes the yield
line run at slope :math:`r k` through the first yield point, and the two forms of growth are ours.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.hysteresis.bilinear import REVERSAL
from pound_solve.laws import Branch, Exit

State = tuple[str, float, float, float]  #: branch, p+ and p- (at entry), plastic work so far (at entry)


@dataclass(frozen=True, slots=True)
class Slackness:
    """The rule for one component; symbols as at the head of the file."""

    k: float
    fy_plus: float
    fy_minus: float
    gap_plus: float
    gap_minus: float
    r: float = 0.0
    grow: bool = True

    def start(self) -> State:
        """Virgin state."""
        return "slack", 0.0, 0.0, 0.0

    def branch(self, state: State) -> Branch:
        """Linear piece of `state`."""
        name, plus, minus, _ = state
        k, hard = self.k, self.k * self.r / (1.0 - self.r)
        on_plus, on_minus = self.gap_plus + plus, self.gap_minus + minus
        if name == "slack":
            return Branch(name, 0.0, 0.0, 0.0, (Exit(1.0, 0.0, -on_plus), Exit(-1.0, 0.0, on_minus)))
        if name == "elastic +":
            fy = self.fy_plus + hard * plus
            off = Exit(-k, 0.0, k * on_plus + max(self._back(state), 0.0))
            return Branch(name, k, 0.0, -k * on_plus, (Exit(k, 0.0, -k * on_plus - fy), off))
        if name == "elastic -":
            fy = self.fy_minus + hard * minus
            off = Exit(k, 0.0, -k * on_minus - min(self._back(state), 0.0))
            return Branch(name, k, 0.0, -k * on_minus, (Exit(-k, 0.0, k * on_minus + fy), off))
        gap, fy = self._line(name)
        slope = self.r * k
        force0 = (1.0 - self.r) * fy - slope * gap
        if name in REVERSAL:
            return Branch(name, slope, 0.0, force0, (REVERSAL[name],))
        sign = 1.0 if name[-1] == "+" else -1.0
        turn, off = Exit(0.0, sign, 0.0), Exit(-sign * slope, 0.0, -sign * force0)
        return Branch(name, slope, 0.0, force0, (turn, off))

    def _line(self, name: str) -> tuple[float, float]:
        """Gap and yield force of a yield line; the sign in its name is the side of the slack it is on."""
        gap = self.gap_plus if name[-1] == "+" else self.gap_minus
        return gap, self.fy_plus if (name[-1] == "+") != ("back" in name) else self.fy_minus

    def _back(self, state: State) -> float:
        """Force at which the spring yields back, if it gets so far before it lets go."""
        name, plus, minus, _ = state
        if self.grow:
            return 0.0
        hard = self.k * self.r / (1.0 - self.r)
        return self.fy_minus + hard * minus if name == "elastic +" else self.fy_plus + hard * plus

    def leave(self, state: State, exit_index: int, d: float) -> State:
        """Take hold, yield, let go, or unload where the motion turns."""
        name, plus, minus, work = state
        if name.startswith("yielding"):
            plus, minus = self._plastic(state, d)
            return ("elastic " + name[-1], "slack")[exit_index], plus, minus, self.dissipated(state, d)
        if name == "slack":
            name = ("elastic +", "elastic -")[exit_index]
        else:
            side = name[-1]
            back = self._back(state) > 0.0 if side == "+" else self._back(state) < 0.0
            name = ("yielding " + side, "yielding back " + side if back else "slack")[exit_index]
        return name, plus, minus, work

    def _plastic(self, state: State, d: float) -> tuple[float, float]:
        name, plus, minus, _ = state
        if not name.startswith("yielding"):
            return plus, minus
        now = d - self._line(name)[0] - self.branch(state).force(d, 0.0) / self.k
        if not self.grow:
            return now, now
        return (now, minus) if name == "yielding +" else (plus, now)

    def stored(self, state: State, d: float) -> float:
        """Recoverable energy; hardening is recoverable only where the slack zone moves as a whole."""
        force = self.branch(state).force(d, 0.0)
        hard = 0.0 if self.grow else self.k * self.r / (1.0 - self.r) * self._plastic(state, d)[0] ** 2
        return 0.5 * force * force / self.k + 0.5 * hard

    def dissipated(self, state: State, d: float) -> float:
        """Plastic work so far."""
        name, plus, minus, work = state
        if not name.startswith("yielding"):
            return work
        side = 0 if name[-1] == "+" else 1
        fy, before = self._line(name)[1], (plus, minus)[side]
        now = self._plastic(state, d)[side]
        hard = self.k * self.r / (1.0 - self.r) if self.grow else 0.0
        return work + fy * (now - before) + 0.5 * hard * (now * now - before * before)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Slackness:
    """Rule from a card's values, a stiffness and the two yield forces."""
    gap = values["SLACK"]
    gap_minus = gap[1] if len(gap) == 2 else -gap[0]
    if gap[0] < 0 or gap_minus > 0:
        raise ValueError("SLACK is written positive, then negative (signed)")
    return Slackness(k, fy_plus, fy_minus, gap[0], gap_minus, values["R"], values["GROW"] == "YES")


SPEC = Spec(
    "hysteresis",
    "BILINEAR_SLACK",
    "bilinear with slackness",
    (
        Field(
            "R",
            Kind.REAL,
            "-",
            default=0.0,
            lo=0.0,
            below=1.0,
            doc="post-yield stiffness as a share of the initial",
        ),
        Field(
            "SLACK",
            Kind.REAL,
            "L",
            default=(0.0,),
            count=(1, 2),
            doc="deformation at which it takes hold, positive and (signed) negative; "
            "one value: the same both ways",
        ),
        Field(
            "GROW",
            Kind.WORD,
            default="YES",
            words=("YES", "NO"),
            codes={"YES": 0, "NO": 1},
            doc="slack grows with yield",
        ),
    ),
    code=5,
    reference="Ruaumoko rule 5",
    impl=build,
)
