"""State of the kernels: named arrays in the order of elimination, and the records of a run.

Every array has a name and one place where it is allocated (`allocation`).  An instant of the motion is a
`MotionState`; a step has one at its start, ``now``, and one at its end, ``trial``, until it is accepted.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

from pound_solve.integrate.energy import Works
from pound_solve.integrate.tracker import TrackedExtremes
from pound_solve.numerics.ldl import Pattern, Positions
from pound_solve.numerics.types import Array, Flags, Index

#: why a kernel returns to Python.  DONE: all goals are reached; FULL: Python must empty the buffers;
#: RUNAWAY: the energy grows without bound; CHATTER, CROWD: too many changes of branch at an instant, in a
#: step; PIVOT: a matrix is singular; NEWTON: no convergence; LOST_FORCE: a law that holds a massless
#: unknown has lost its force; SHORT: the step is lost in the rounding of the time; LOOSE: nothing holds a
#: massless unknown; STRIKE: a rigid contact strikes or parts
DONE, FULL, RUNAWAY, CHATTER, CROWD, PIVOT, NEWTON, LOST_FORCE, SHORT, LOOSE, STRIKE = range(11)
#: rows of `Step.factors` and of their pivots: A for the nominal step, A for a part of it, M, and
#: ``K + C / e``, e a tiny time, over the massless unknowns
WHOLE, PART, MASS, MASSLESS = range(4)
TURN, STIFFNESS = -2, -1  #: columns of `LawState.internal` beside the rule's own (see `SecantLaw`)
#: columns of `Buffers.log`: law, branches before and after, t, d, v, force; peak, its time, impulse
LOGGED = 10


class Run(Protocol):
    """Counters and clocks of a run: a numpy record."""

    started: int  #: whether the first sample is taken
    goal: int  #: the time that is integrated to, by its number
    step: int  #: steps taken towards the goal
    kept: int  #: samples in the buffers
    logged: int  #: transitions in the buffers
    shown: int  #: motions between samples in the buffers
    steps: int
    events: int
    same_instant: int  #: transitions at one instant
    lost_force: int  #: law that held a joint without mass and lost its force, -1 for none
    driven: int  #: branches left in a step that is not cut at events
    updates: int  #: of rank one since the factor was made
    stale: int  #: whether quantities that depend on the branches, such as factors, must be recomputed
    softening: int  #: steps that are too long for a softening branch
    tied: int  #: instants at which laws give way together in the buffers
    rests: int  #: laws that rest where a branch begins in the buffers
    fault: int  #: law or unknown at fault, -1 for none
    time: float
    factor_length: float  #: step that the factor at hand is for
    initial_energy: float  #: kinetic and recoverable
    longest_part: float  #: that a step may take at once for now
    remaining_step: float  #: of a step that stopped where a force lost_force, negative for none
    last_event: float  #: time of the last transition
    jumped: float  #: time at which a load has jumped, negative for none


class Product(NamedTuple):
    """A matrix to be multiplied with: along its diagonals where they are full enough, else row by row.

    Attributes
    ----------
    offsets : ndarray, shape (n_diagonals,)
        Column less row; the first is zero.
    diagonals : ndarray, shape (n_diagonals, n)
        Their entries, from the first row that has one.
    row : ndarray, shape (n_rows,)
        Rows that have other entries.
    pointers : ndarray, shape (n_rows + 1,)
    columns, values : ndarray, shape (n_others,)
        These entries.
    """

    offsets: Index
    diagonals: Array
    row: Positions
    pointers: Positions
    columns: Positions
    values: Array


class Rows(NamedTuple):
    """Sparse rows over the unknowns.

    Attributes
    ----------
    pointers : ndarray, shape (n_rows + 1,)
    columns, values : ndarray, shape (n_entries,)
    """

    pointers: Positions
    columns: Positions
    values: Array


class LinearSystem(NamedTuple):
    """The linear part of the equations of motion, constant through a run.

    Attributes
    ----------
    stiffness, damping, mass : Product
    inputs : ndarray, shape (n_inputs, n)
        Loads of unit inputs.
    nodal_inputs : ndarray, shape (n, n_inputs)
        The part of them that is forces on nodes.
    constant : ndarray, shape (n,)
        Constant loads.
    pattern : Pattern
        Of A and its factor.
    on_pattern : ndarray, shape (3, n_entries)
        M, C and K on the pattern.
    column : ndarray, shape (n_entries,)
        Columns of the pattern's entries.
    has_mass : ndarray, shape (n,)
        Which unknowns have mass.
    all_mass : bool
        Whether all have.
    massless_vary : bool
        Whether the stiffness of massless unknowns changes along a branch: by curved laws or by corotational
        members.
    instant : float
        A time that is tiny against a step, for the velocities of massless unknowns.
    implicit : bool
        Whether the stiffness is in the pattern.
    diagonal : bool
        Whether M is.
    explicit : bool
        Whether a step needs no factor: M + gamma h C is diagonal and never changes.
    monitored : Rows
        Monitored outputs over the unknowns.
    monitored_inputs : ndarray, shape (n_monitored, n_inputs)
    monitored_constants : ndarray, shape (n_monitored,)
    reactions : ndarray, shape (3, n_moved, n)
        Of moved supports from displacements, velocities, accelerations; empty with one motion for the base.
    support_forces, support_rates : ndarray, shape (n_moved, n_inputs)
        Reactions from the inputs, and the supports' velocities.
    support_damping : ndarray, shape (n_moved, n_moved)
    """

    stiffness: Product
    damping: Product
    mass: Product
    inputs: Array
    nodal_inputs: Array
    constant: Array
    pattern: Pattern
    on_pattern: Array
    column: Index
    has_mass: Flags
    all_mass: bool
    massless_vary: bool
    instant: float
    implicit: bool
    diagonal: bool
    explicit: bool
    monitored: Rows
    monitored_inputs: Array
    monitored_constants: Array
    reactions: Array
    support_forces: Array
    support_rates: Array
    support_damping: Array


class MemberState(NamedTuple):
    """Corotational members at one instant.

    Attributes
    ----------
    quantities, forces : ndarray, shape (n_members, 6)
        Their quantities (see `structure.corotational`) and the forces on them.
    """

    quantities: Array
    forces: Array


class Corotational(NamedTuple):
    """Members whose forces follow their displaced line (see `structure.corotational`).

    Attributes
    ----------
    parameters : ndarray, shape (n_members, 10)
    pointers : ndarray, shape (n_members + 1,)
        Into the unknowns that each touches.
    unknown : ndarray, shape (n_touched,)
    rows : ndarray, shape (n_touched, 6)
        Their share in the six quantities.
    pair_pointers : ndarray, shape (n_members + 1,)
        Into the pairs of unknowns.
    pair : ndarray, shape (n_pairs, 3)
        Position in the pattern of A, and the two touched ones.
    inputs : ndarray, shape (n_members, 6, n_inputs)
    supports : ndarray, shape (n_members, 6, n_moved)
    now, trial : MemberState
    predicted : ndarray, shape (n_members, 6)
        Quantities at the end of the step but for the acceleration there.
    at_zero : ndarray, shape (n_members, 6)
        Forces at zero quantities of the straight line that stands for the member in an iteration.
    tangent : ndarray, shape (n_members, 36)
        Tangents that are in the factor.
    present_tangent : ndarray, shape (n_members, 36)
        Tangents at the present quantities.
    product : ndarray, shape (most touched, 6)
        Scratch.
    largest : ndarray, shape (1,)
        Largest force so far.
    """

    parameters: Array
    pointers: Positions
    unknown: Index
    rows: Array
    pair_pointers: Positions
    pair: Index
    inputs: Array
    supports: Array
    now: MemberState
    trial: MemberState
    predicted: Array
    at_zero: Array
    tangent: Array
    present_tangent: Array
    product: Array
    largest: Array


class LawDefinition(NamedTuple):
    """Constants of the laws through a run.  Arrays of one number per law have shape (n_laws,).

    Attributes
    ----------
    rows : Rows
        Deformation of each law from the unknowns: its row b, by which its force also acts on them.
    inputs : ndarray, shape (n_laws, n_inputs)
        Deformations from unit inputs.
    pair_pointers, pair_places, pair_values : ndarray
        Where the ``b b^T`` of each law adds to A: pointers, positions in the pattern of A, products.
    supports : ndarray, shape (n_laws, n_moved)
        Deformations from unit displacements of moved supports.
    rule : ndarray of int
        Number of the law's rule in the tables of functions.
    curved, contact, viscous : ndarray of int
        Whether the law is curved; whether it is a contact; whether damping is part of the force that is
        reported.
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
    viscous: Index
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
        Internal variables of the rule; the last two serve the secant stiffness (`TURN`, `STIFFNESS`).
    dashpot_loss : ndarray
        Energy lost in the law's dashpot so far [F L]; a `SavedState` does not have it.
    """

    branch: Index
    entry_deformation: Array
    entry_work: Array
    internal: Array
    dashpot_loss: Array


class SavedState(NamedTuple):
    """States of the laws to go back to: from a trial, or to the start of a step that is not cut at events.

    Attributes
    ----------
    in_step : ndarray of bool, shape (n_laws,)
        Whether the law has left its branch in the present step, so that `values` has its state at the
        start of the step; only used where steps are not cut at events.
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
        Number of the event by which the law is to leave its branch at the present instant; -1 for none.
    """

    n_events: Index
    coefficients: Array
    pending: Index


class FrictionCoupling(NamedTuple):
    """Coupled laws, those of friction: their strength is a share of the force of another law.

    Arrays but for `coupled` have a row for every law; only those of coupled laws are used.

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
        c of the event functions at the start of the step: it changes with the normal force.
    limit_rates, limit_rates_at_start : ndarray, shape (n_laws, EVENTS)
        Rates of c, at the end of the step that was tried and at its start.
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
        Largest sum of the absolute terms that a rate is made of: its rounding is a share of them, however
        small it is itself; as large from the start that a structure at rest moves by less.
    """

    deformation: Array
    rate: Array
    terms: Array


class CollisionForces(NamedTuple):
    """Forces of the contacts in the collision that is under way, shape (n_laws,).

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
        At the start of the step and at its end.
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


class MotionState(NamedTuple):
    """The motion of the unknowns at one instant, shape (n,), and what drives it.

    Attributes
    ----------
    displacement, velocity, acceleration : ndarray
    damping_force, damping_rate : ndarray
        ``C v`` and ``C a``.
    load : ndarray
    inputs, input_rates : ndarray, shape (n_inputs,)
        The excitation and its rate.
    """

    displacement: Array
    velocity: Array
    acceleration: Array
    damping_force: Array
    damping_rate: Array
    load: Array
    inputs: Array
    input_rates: Array


class Step(NamedTuple):
    """A step from one instant to the next, and scratch space.

    Attributes
    ----------
    now, trial : MotionState
        At its start and at its end.
    residual : ndarray, shape (n,)
        ``p - C v - K u - f`` at the start, in balance with the inertia.
    right_side : ndarray, shape (n,)
        Of the equations for the acceleration, laws apart.
    marked : ndarray, shape (n,)
        Which unknowns are held by a law that has left its branch at the present instant.
    scratch : ndarray, shape (4, n)
    row : ndarray, shape (n,)
        Scratch of the factorisation; zero between uses.
    matrix : ndarray, shape (n_entries,)
        Values of A.
    factors : ndarray, shape (4, n_entries of L)
        Rows `WHOLE`, `PART`, `MASS` (ones for massless unknowns), `MASSLESS` (ones for the others).
    pivots : ndarray, shape (4, n)
    extremes : TrackedExtremes
    """

    now: MotionState
    trial: MotionState
    residual: Array
    right_side: Array
    marked: Flags
    scratch: Array
    row: Array
    matrix: Array
    factors: Array
    pivots: Array
    extremes: TrackedExtremes


class Buffers(NamedTuple):
    """Samples, transitions and motions that are kept until Python fetches them.

    Attributes
    ----------
    displacement, velocity, acceleration : ndarray, shape (n_samples, n)
    force, stored, lost, dashpot : ndarray, shape (n_samples, n_laws)
        Of the laws: forces, recoverable and lost energies, forces of dashpots beside springs.
    time : ndarray, shape (n_samples,)
    works : ndarray, shape (n_samples, 3)
        Input, lost in the structure's, in the contacts' dashpots.
    log : ndarray, shape (n_log, LOGGED)
        Transitions.
    ties : ndarray, shape (n_ties, 3, n_laws)
        Of instants at which laws come to their events together: tangents and dashpots if these go on, and
        the rates at which they come; zero for all others (see `ties.note_ties`).
    tie_time : ndarray, shape (n_ties,)
    rests : ndarray, shape (n_rests, 4)
        Of laws that rest where a branch begins as a law turns: the time, that law, the one that rests, and
        the number of its branch (see `ties.note_rests`).
    which : ndarray, shape (n_which,)
        Unknowns that the envelopes look at.
    shown : ndarray, shape (n_shown, 3, n_which)
        Their motion between the samples.
    shown_time : ndarray, shape (n_shown,)
    acting : ndarray, shape (n_acting,)
        Laws that the envelopes look at.
    law_forces : ndarray, shape (n_shown, n_acting)
        Their forces between the samples, all dashpots included.
    """

    displacement: Array
    velocity: Array
    acceleration: Array
    force: Array
    stored: Array
    lost: Array
    dashpot: Array
    time: Array
    works: Array
    log: Array
    ties: Array
    tie_time: Array
    rests: Array
    which: Index
    shown: Array
    shown_time: Array
    acting: Index
    law_forces: Array


class Scheme(NamedTuple):
    """Parameters of the generalised-alpha family, and whether events are located."""

    beta: float
    gamma: float
    alpha_m: float = 0.0
    alpha_f: float = 0.0
    locate: bool = True


class Goals(NamedTuple):
    """Times that a run integrates to one after the other, and the excitation on the way.

    Attributes
    ----------
    times : ndarray, shape (n_goals,)
    sampled : ndarray, shape (n_goals,)
        Whether a sample is taken there.
    piece : ndarray, shape (n_goals,)
        Piece of the excitation up to there.
    coefs : ndarray, shape (n_pieces, degree + 1, n_inputs)
        Polynomials of the excitation.
    begins : ndarray, shape (n_pieces,)
        Times at which the pieces begin.
    """

    times: Array
    sampled: Flags
    piece: Index
    coefs: Array
    begins: Array


class Piece(NamedTuple):
    """A piece of the excitation, over which the inputs are polynomials of the time.

    Attributes
    ----------
    coefs : ndarray, shape (degree + 1, n_inputs)
        Coefficients of the powers of the time since `begin`.
    begin : float
        Time at which the piece begins.
    """

    coefs: Array
    begin: float


def piece_of(goals: Goals, goal: int) -> Piece:
    """The piece of the excitation up to a goal."""
    piece = goals.piece[goal]
    return Piece(goals.coefs[piece], goals.begins[piece])


class Simulation(NamedTuple):
    """All that a run works on, whatever its method; kernels are handed it as one.

    Attributes
    ----------
    linear : LinearSystem
    laws : Laws
    members : Corotational
    step : Step
    buffers : Buffers
    works : Works
    run : Run
    """

    linear: LinearSystem
    laws: Laws
    members: Corotational
    step: Step
    buffers: Buffers
    works: Works
    run: Run
