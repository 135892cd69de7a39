"""State of the laws in the kernels: their constants, and what changes with their branches and motion."""

from __future__ import annotations

from typing import NamedTuple

from pound_solve.integrate.kernels.sparse import Rows
from pound_solve.numerics.ldl import Positions
from pound_solve.numerics.types import Array, Flags, Index

#: columns of `LawState.internal` beside those of the rule (see `SecantLaw`)
LARGEST_REVERSAL, SECANT_STIFFNESS = -2, -1


class LawDefinition(NamedTuple):
    """Constants of the laws through a run.  Arrays of one number per law have shape (n_laws,).

    Attributes
    ----------
    rows : Rows
        Row b of each law: it gives the deformation from the unknowns, and its force acts on them along b.
    inputs : ndarray, shape (n_laws, n_inputs)
        Deformations due to unit inputs.
    pair_pointers, pair_places, pair_values : ndarray
        Where the ``b b^T`` of each law adds to A: pointers, positions in the pattern of A, products.
    supports : ndarray, shape (n_laws, n_moved)
        Deformations due to unit displacements of moved supports.
    rule : ndarray of int
        Number of the law's rule in the tables of functions.
    curved, contact, reports_damping : ndarray of int
        Whether the law is curved; whether it is a contact; whether the reported force includes damping.
    tangent_damping, secant_damping : ndarray
        Dashpot as a multiple of the tangent stiffness, and of the secant stiffness [T].
    parameters : ndarray, shape (n_laws, PARAMETERS)
        Parameters of the rule.
    """

    rows: Rows
    inputs: Array
    pair_pointers: Positions
    pair_places: Positions
    pair_values: Array
    supports: Array
    rule: Index
    curved: Index
    contact: Index
    reports_damping: Index
    tangent_damping: Array
    secant_damping: Array
    parameters: Array


class LawState(NamedTuple):
    """Branches and memory of the laws.  Arrays of one number per law have shape (n_laws,).

    Attributes
    ----------
    branch : ndarray of int
        Number of the branch in the rule.
    entry_deformation, entry_work : ndarray
        Deformation at which the branch was entered, and the work done on the law up to there [F L].
    internal : ndarray, shape (n_laws, VARIABLES + 2)
        Internal variables of the rule; the last two (`LARGEST_REVERSAL`, `SECANT_STIFFNESS`) are for the
        secant stiffness.
    dashpot_loss : ndarray
        Energy lost in the law's dashpot so far [F L]; a `SavedState` does not have it.
    """

    branch: Index
    entry_deformation: Array
    entry_work: Array
    internal: Array
    dashpot_loss: Array


class SavedState(NamedTuple):
    """States of the laws to restore after a trial, or at the start of a step that is not cut at events.

    Attributes
    ----------
    in_step : ndarray of bool, shape (n_laws,)
        Whether the law has left its branch in the present step, so that `values` holds its state at the
        start of the step; used only if steps are not cut at events.
    values : ndarray, shape (n_laws, 3 + VARIABLES + 2)
        Branch, deformation and work at its entry, internal variables (see `LawState`).
    """

    in_step: Flags
    values: Array


class LawTangent(NamedTuple):
    """Linear branches of the laws, or tangents of curved ones: ``f = k d + c v + f0``; shape (n_laws,).

    Attributes
    ----------
    stiffness, damping, offset : ndarray
        k [F/L], c [F T/L] and f0 [F].
    """

    stiffness: Array
    damping: Array
    offset: Array


class BranchEvents(NamedTuple):
    """Events that end the laws' branches: a law leaves its branch as an event function rises above zero.

    Attributes
    ----------
    n_events : ndarray of int, shape (n_laws,)
        Number of the branch's event functions.
    coefficients : ndarray, shape (n_laws, EVENTS, 3)
        a, b and c of each event function, ``a d + b v + c``.
    pending : ndarray of int, shape (n_laws,)
        Number of the event by which the law leaves its branch at the present instant; -1 for none.
    """

    n_events: Index
    coefficients: Array
    pending: Index


class FrictionCoupling(NamedTuple):
    """Coupled laws (friction), whose strength is a fraction of the force of another law.

    All arrays except `coupled` have a row for every law; only the rows of coupled laws are used.

    Attributes
    ----------
    coupled : ndarray, shape (n_coupled,)
        The coupled laws; each comes after the law that presses it.
    normal_law : ndarray of int, shape (n_laws,)
        The law whose force is the normal force; -1 for a law that is not coupled.
    pressed_branches : ndarray of int, shape (n_laws,)
        A bit for each branch of the normal law on which it is pressed.
    force : ndarray, shape (n_laws,)
        Friction force at the start of the step [F].
    offset_rate : ndarray, shape (n_laws,)
        Rate of the tangent's f0 due to the normal force [F/T].
    limits_at_start : ndarray, shape (n_laws, EVENTS)
        c of the event functions at the start of the step; c changes with the normal force.
    limit_rates, limit_rates_at_start : ndarray, shape (n_laws, EVENTS)
        Rates of c at the end of the trial step and at its start.
    """

    coupled: Index
    normal_law: Index
    pressed_branches: Index
    force: Array
    offset_rate: Array
    limits_at_start: Array
    limit_rates: Array
    limit_rates_at_start: Array


class LawMotion(NamedTuple):
    """Deformations and rates of the laws at one instant, shape (n_laws,)."""

    deformation: Array
    rate: Array


class LawExtremes(NamedTuple):
    """Largest magnitudes of the laws' motion so far, by which rounding is judged; shape (n_laws,).

    Attributes
    ----------
    deformation, rate : ndarray
    terms : ndarray
        Largest sum of the absolute terms of a rate.  The rounding of a rate is a fraction of it, however
        small the rate.  It starts at a size beside which the rounding of a state of rest is no motion.
    """

    deformation: Array
    rate: Array
    terms: Array


class CollisionForces(NamedTuple):
    """Forces of the contacts in the present collision, shape (n_laws,).

    Attributes
    ----------
    peak_force, peak_time, impulse : ndarray
        Largest force so far [F], its time [T], and the integral of the force over the time [F T].
    """

    peak_force: Array
    peak_time: Array
    impulse: Array


class Laws(NamedTuple):
    """The laws: their constants, their state, and what follows from it at the present instant.

    Attributes
    ----------
    definition : LawDefinition
    state : LawState
    saved : SavedState
    tangent : LawTangent
    events : BranchEvents
    friction : FrictionCoupling
    now, trial : LawMotion
        Motion at the start of the step and at its end.
    largest : LawExtremes
    collision : CollisionForces
    """

    definition: LawDefinition
    state: LawState
    saved: SavedState
    tangent: LawTangent
    events: BranchEvents
    friction: FrictionCoupling
    now: LawMotion
    trial: LawMotion
    largest: LawExtremes
    collision: CollisionForces
