"""State of the kernels: named arrays in the order of elimination, and the records of a run.

Every array has a name and is allocated in one place (`allocation`).  An instant of the motion is a
`MotionState`; a step has one at its start, ``now``, and one at its end, ``trial``, until it is accepted.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

from pound_solve.integrate.energy import Works
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.sparse import Product, Rows
from pound_solve.integrate.tracker import TrackedExtremes
from pound_solve.numerics.ldl import Pattern, Positions
from pound_solve.numerics.types import Array, Flags, Index

# why a kernel returns to Python
DONE = 0  #: all goals are reached
BUFFERS_FULL = 1  #: Python must empty the buffers
RUNAWAY = 2  #: the energy grows without bound
CHATTER = 3  #: too many changes of branch at one instant
TOO_MANY_EVENTS = 4  #: more changes of branch in one step than the log has room for
SINGULAR = 5  #: a matrix is singular
NOT_CONVERGED = 6  #: Newton's iterations do not converge
LOST_FORCE = 7  #: a law that holds a massless unknown has lost its force
STEP_TOO_SHORT = 8  #: the step is lost in the rounding of the time
UNRESTRAINED = 9  #: nothing holds a massless unknown
RIGID_EVENT = 10  #: a rigid contact strikes or parts
#: rows of `Step.factors` and of their pivots: A for the nominal step, A for a part of it, M, and
#: ``K + C / e``, e a tiny time, over the massless unknowns
WHOLE, PART, MASS, MASSLESS = range(4)
M_ROW, C_ROW, K_ROW = range(3)  #: rows of `LinearSystem.on_pattern`
#: columns of `Buffers.log`: the law, its branches before and after, time, deformation, rate, force; peak
#: force, its time and impulse of the contact since the last change
LOG_LAW, LOG_BEFORE, LOG_AFTER, LOG_TIME, LOG_DEFORMATION, LOG_RATE, LOG_FORCE = range(7)
LOG_PEAK, LOG_PEAK_TIME, LOG_IMPULSE, LOG_COLUMNS = range(7, 11)
#: rows of `Buffers.ties` of an instant; for a law that loses its force, the first holds minus infinity and
#: the second its next branch
TIE_STIFFNESS, TIE_DAMPING, TIE_RATE = range(3)


class Run(Protocol):
    """Counters and clocks of a run: a numpy record."""

    started: int  #: whether the first sample is taken
    goal: int  #: number of the present goal
    step: int  #: steps taken towards the goal
    n_samples: int  #: samples in the buffers
    n_transitions: int  #: transitions in the buffers
    n_motions: int  #: motions between samples in the buffers
    steps: int
    events: int
    changes_at_instant: int  #: transitions at one instant
    lost_force: int  #: law that held a massless joint and lost its force, -1 for none
    branches_passed: int  #: branches left in a step that is not cut at events
    updates: int  #: rank-one updates since the factorisation; above `MAX_UPDATES` if the factor is invalid
    branches_changed: int  #: whether sums, modes and factors over the laws must be recomputed (series)
    massless_factor_stale: int  #: whether row `MASSLESS` of the factors must be recomputed (steps)
    softening: int  #: steps that are too long for a softening branch
    n_ties: int  #: instants in the buffers at which laws yield or fail together
    n_rests: int  #: laws in the buffers that rest at the start of a branch
    changed_law: int  #: law that changed its branch last, -1 for none
    failed_law: int  #: law for which Newton's iterations last failed to converge, -1 for none
    failed_unknown: int  #: unknown whose pivot vanished, -1 for none
    time: float
    factor_length: float  #: step length of the present factor
    initial_energy: float  #: kinetic and recoverable
    runaway_energy: float  #: kinetic energy that stopped the run
    longest_part: float  #: longest part of a step that is allowed at present
    #: rest of a step in which a law lost the force that held a massless unknown, negative for none
    remaining_step: float
    last_event: float  #: time of the last transition
    load_jump_time: float  #: time at which a load has jumped, negative for none


class LinearSystem(NamedTuple):
    """The linear part of the equations of motion, constant through a run.

    Attributes
    ----------
    stiffness, damping, mass : Product
    inputs : ndarray, shape (n_inputs, n)
        Loads of unit inputs.
    nodal_inputs : ndarray, shape (n, n_inputs)
        The part of these loads that acts on nodes as forces.
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
        Whether all unknowns have mass.
    massless_vary : bool
        Whether the stiffness of massless unknowns changes along a branch: by curved laws or by corotational
        members.
    instant : float
        A time much shorter than a step, for the velocities of massless unknowns.
    has_stiffness : bool
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
        Reactions of moved supports due to displacements, velocities, accelerations; empty for one base
        motion.
    support_forces, support_rates : ndarray, shape (n_moved, n_inputs)
        Reactions due to the inputs, and the supports' velocities.
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
    has_stiffness: bool
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
        Pointers into the unknowns that each member touches.
    unknown : ndarray, shape (n_touched,)
    rows : ndarray, shape (n_touched, 6)
        Coefficients of these unknowns in the six quantities.
    pair_pointers : ndarray, shape (n_members + 1,)
        Pointers into the pairs of unknowns.
    pair : ndarray, shape (n_pairs, 3)
        Position in the pattern of A, and the two unknowns by their index in `unknown`.
    inputs : ndarray, shape (n_members, 6, n_inputs)
    supports : ndarray, shape (n_members, 6, n_moved)
    now, trial : MemberState
    predicted : ndarray, shape (n_members, 6)
        Quantities at the end of the step without the terms of the acceleration there.
    at_zero : ndarray, shape (n_members, 6)
        Linearised forces of the member in an iteration, at zero quantities.
    tangent : ndarray, shape (n_members, 36)
        Tangents that the factor contains.
    present_tangent : ndarray, shape (n_members, 36)
        Tangents at the present quantities.
    product : ndarray, shape (most touched, 6)
        Scratch.
    largest : ndarray, shape (1,)
        Largest force so far: a cell that kernels write.
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
        Motion at its start and at its end.
    residual : ndarray, shape (n,)
        ``p - C v - K u - f`` at the start, in balance with the inertia.
    right_side : ndarray, shape (n,)
        Right side of the equations for the acceleration, without laws.
    marked : ndarray, shape (n,)
        Which unknowns are held by a law that has left its branch at the present instant.
    scratch : ndarray, shape (4, n)
        Rows that a kernel names and fills as it needs; it loses them where it calls another such kernel.
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
        Forces of the laws, recoverable and lost energies, forces of dashpots parallel to springs.
    time : ndarray, shape (n_samples,)
    works : ndarray, shape (n_samples, 3)
        Input, loss in the structure's dashpots, loss in the contacts' dashpots.
    log : ndarray, shape (n_log, LOG_COLUMNS)
        Transitions.
    ties : ndarray, shape (n_ties, 3, n_laws)
        For each instant at which laws reach their events together: tangents and dashpots of these laws if
        they continue, and their rates; zero for all other laws (see `ties.note_ties`).
    tie_time : ndarray, shape (n_ties,)
    rests : ndarray, shape (n_rests, 4)
        For each law that rests at the start of a branch as a law reverses: the time, the reversing law, the
        resting law, and the number of its branch (see `ties.note_rests`).
    enveloped_unknowns : ndarray, shape (n_unknowns,)
        Unknowns that the envelopes need.
    motion : ndarray, shape (n_motions, 3, n_unknowns)
        Their motion between the samples.
    motion_time : ndarray, shape (n_motions,)
    enveloped_laws : ndarray, shape (n_laws,)
        Laws whose forces the envelopes need.
    law_forces : ndarray, shape (n_motions, n_laws)
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
    enveloped_unknowns: Index
    motion: Array
    motion_time: Array
    enveloped_laws: Index
    law_forces: Array


class Scheme(NamedTuple):
    """Parameters of the generalised-alpha family, and whether events are located."""

    beta: float
    gamma: float
    alpha_m: float = 0.0
    alpha_f: float = 0.0
    locate: bool = True


class Goals(NamedTuple):
    """Times to which a run integrates in turn, and the excitation on the way.

    Attributes
    ----------
    times : ndarray, shape (n_goals,)
    sampled : ndarray, shape (n_goals,)
        Whether a sample is taken at the goal.
    piece : ndarray, shape (n_goals,)
        Piece of the excitation up to the goal.
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
    """A piece of the excitation, over which the inputs are polynomials in time.

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
    """Return the piece of the excitation up to a goal."""
    piece = goals.piece[goal]
    return Piece(goals.coefs[piece], goals.begins[piece])


class Simulation(NamedTuple):
    """The complete state of a run of any method, passed to kernels as one argument.

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
