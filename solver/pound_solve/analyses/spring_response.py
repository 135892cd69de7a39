"""Response of every spring and hinge in a history: peaks, plastic deformation and damage."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from pound_solve.analyses import damage
from pound_solve.analyses.recorder import HistoryRecorder
from pound_solve.integrate.protocol import Outcome
from pound_solve.integrate.tracker import Extreme
from pound_solve.laws.automaton import STRENGTHLESS, BranchKind
from pound_solve.structure.elements.base import LawSpring, Role
from pound_solve.structure.structure import Structure

#: plastic rotation at which concrete members begin to lose strength [rad]: FEMA 356 (2000), Prestandard and
#: commentary for the seismic rehabilitation of buildings, Tables 6-7 and 6-8, give 0.015 to 0.025 for beams
#: and 0.012 to 0.02 for columns with confining ties
ORDINARY_ROTATION: Final = 0.02
ENDS: Final = ("DUCTU", "DULT", "DU")  #: items that limit a component's validity or capacity


class PlasticDeformation(NamedTuple):
    """Deformations [L] or [rad] of a spring that has lost energy.

    Attributes
    ----------
    last : float
        At the end.
    residual : float
        After unloading; NaN if the run stopped early.
    path : float
        Plastic work divided by the yield force.
    path_ratio : float
        Path divided by the yield deformation [-].
    """

    last: float
    residual: float
    path: float
    path_ratio: float


@dataclass(frozen=True)
class SpringResponse:
    """Response of one spring or hinge.

    Attributes
    ----------
    spring : LawSpring
    force, deformation : Extreme
        [F] or [F L]; [L] or [rad].
    yields : float
        Number of times that it started to yield; NaN for a rule without a yield line.
    ductility : float
        Largest absolute deformation divided by the yield deformation; NaN if there is none.
    loss : float
        Energy lost in hysteresis [F L].
    plastic : PlasticDeformation or None
        None if no energy was lost, and for friction, which has no residual deformation.
    damage : Damage or None
        None if the deck gives no ultimate ductility.
    failed : bool
        Whether the rule has reduced its strength to zero, for example at an ultimate deformation.
    rotation : float
        Largest plastic rotation of a hinge [rad]; NaN for other components.
    ends : bool
        Whether the deck gives a limit: DUCTU, or an item of the rule (`ENDS`).
    """

    spring: LawSpring
    force: Extreme
    deformation: Extreme
    yields: float
    ductility: float
    loss: float
    plastic: PlasticDeformation | None
    damage: damage.Damage | None
    failed: bool
    rotation: float
    ends: bool

    @property
    def beyond_ordinary(self) -> bool:
        """Whether a hinge without a limit in the deck has rotated beyond `ORDINARY_ROTATION`."""
        return not self.ends and self.rotation > ORDINARY_ROTATION

    @property
    def deformation_unit(self) -> str:
        """Dimension of the deformation."""
        return "rad" if self.spring.unit == "F*L" else "L"


def spring_responses(
    structure: Structure, recorder: HistoryRecorder, outcome: Outcome, ended: bool
) -> list[SpringResponse]:
    """Return the response of all springs and hinges; `ended`: the history is complete."""
    return [_response(structure, recorder, outcome, ended, i) for i in recorder.items.springs]


def _response(
    structure: Structure, recorder: HistoryRecorder, outcome: Outcome, ended: bool, i: int
) -> SpringResponse:
    spring, peaks, loss = structure.laws[i], outcome.peaks, recorder.losses[i]
    d, f = peaks.deformation[i], peaks.force[i]
    # pair the largest deformation and force, which coincide unless the force falls with the deformation
    largest = spring.whole(d.high, f.high), spring.whole(d.low, f.low)
    plastic = None
    if spring.role.reports_damping:
        loss += peaks.dashpot_losses[i]
    if loss and spring.role is Role.SPRING:  # friction has no separate residual deformation
        last = recorder.deformations[i]
        left = damage.residual(spring.law, outcome.states[i], last) if ended else np.nan
        path = damage.plastic_path(loss, spring.strengths, spring.yields)
        plastic = PlasticDeformation(last, left, *path)
    card = structure.model.props[structure.model.elements[spring.element].prop]
    ultimate = card.values.get("DUCTU")
    index = None
    if ultimate is not None and spring.yields is not None and spring.strengths is not None:
        sides = (ultimate[0], ultimate[-1])
        index = damage.park_ang(largest, loss, spring.strengths, spring.yields, sides, card["PA_BETA"])
    ductility = damage.ductility(largest, spring.yields)
    branches = spring.law.rule.branches
    yielding, at = any(b.kind is BranchKind.YIELDING for b in branches), branches[outcome.states[i][0]]
    turns = spring.unit == "F*L" and spring.component.startswith("hinge")
    return SpringResponse(
        spring,
        f,
        d,
        peaks.yields[i] if yielding else np.nan,
        ductility,
        loss,
        plastic,
        index,
        at.name == STRENGTHLESS,
        damage.plastic(largest, spring.yields) if turns else np.nan,
        any(card.values.get(item) is not None for item in ENDS),
    )
