"""What the kernels work on: arrays in the order of elimination, and names for their rows and columns."""

from __future__ import annotations

from typing import NamedTuple

from pound_solve.laws.functions import VARIABLES
from pound_solve.numerics.ldl import Pattern, Place
from pound_solve.numerics.types import Array, Flags, Index

# why `advance` came back
DONE, FULL, RUNAWAY, CHATTER, CROWD, PIVOT, NEWTON = range(7)
#: integers of `count`
GOAL, STEP, KEPT, LOGGED, STEPS, EVENTS, UPDATES, WORST, SINCE, SHOWN, STALE, FALLING = range(12)
BACK = 1e-6  #: share of its largest rate that a law must move back with before it counts as turned
NEAR = 1e-6  #: share of its largest value within which an exit is taken where it cannot be met better
CLOSE = 1e-9  #: share of a step within which two events are at one instant
SHOWS = 4  #: steps between two outputs, at most, that the envelopes see
#: steps, and steps times unknowns, after which Python may look whether the user wants to stop
PAUSE, BUSY = 100_000, 10_000_000
FIRST = 1.0 / 32.0  #: part of a step taken after a curved contact has touched; it doubles from then on
INSTANT = 1e-6  #: share of the longest step that the time which tells massless velocities keeps below
DELAY = 1e-8  #: share of the longest C / K among massless unknowns that it is
REFRESH = 200  #: updates of rank one before a factor is made anew
COLUMNS = 10  #: of the log: law, branches before and after, t, d, v, force; peak, its time, impulse
# rows of `Motion.q`: at the start (0) and the end (1) of a step; loads; residual; scratch; pivots
U, V, A, U1, V1, A1, CV, CA, CA1, P, P1, R, BASE, Y, W, D = range(16)
HIGH, T_HIGH, LOW, T_LOW, SLOPE, VALUE, STEEPEST = range(7)  #: rows of `Motion.peak`
WHOLE, PIECE, MASS, LIGHT = range(4)  #: rows of `Motion.l`, and of its pivots
# columns of `Laws.f`: the linear piece, exits; entry of the state; motion; dashpot; what a contact counts
K, C, F0, EXIT, D0, WORK = 0, 1, 2, 3, 12, 13
LD, LV, LD1, LV1, MOST_D, MOST_V, BETA, DASHPOT, PEAK, T_PEAK, IMPULSE, SECANT, HELD = range(14, 27)
# columns of `Laws.memory` beside the rule's own (see `SecantLaw`)
TURN, STIFFNESS = VARIABLES, VARIABLES + 1
# columns of `Laws.i`; the last three: the law that this one leans on, or -1, a bit for each branch of that
# one where it is pressed, and whether damping is part of the force that is reported
CODE, CURVED, CONTACT, AT, N_EXITS, SAVED, NORMAL, PRESSED, VISCOUS = range(9)
# columns of `Turning.s`: quantities and forces at the start and the end of a step, quantities at the end
# but for the acceleration there, forces at no quantities of the line that stands for the chord
S0, S1, G0, G1, AHEAD, REST = range(0, 36, 6)
CLEAR = 1e-12  #: share of the largest force that the chords' forces are found to
ROUNDING = 1e-15  #: share of a chord's axial stiffness that its forces are rounded to
SLOW = 0.05  #: part of an error that an iteration may leave before the factor is made anew


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
    row: Place
    pointers: Index
    columns: Place
    values: Array


class Matrices(NamedTuple):
    """The linear part, constant through a run; sparse rows as (pointers, columns, values).

    Attributes
    ----------
    k, c, m : Product
        Stiffness, damping and mass.
    inputs : ndarray, shape (n_inputs, n)
    pushed : ndarray, shape (n, n_inputs)
        The part of them that is forces on nodes.
    constant : ndarray, shape (n,)
    pattern : Pattern
    a : ndarray, shape (3, n_entries)
        M, C and K on the pattern.
    column : ndarray, shape (n_entries,)
        Columns of the pattern's entries.
    heavy : ndarray, shape (n,)
        Which unknowns have mass.
    inert : bool
        Whether all have.
    shifts : bool
        Whether the stiffness of massless unknowns changes along a branch: by curved laws, or by chords.
    instant : float
        A time that is tiny against a step, for massless unknowns.
    implicit : bool
        Whether the stiffness is in the pattern.
    diagonal : bool
        Whether M is.
    explicit : bool
        Whether a step needs no factor: M + gamma h C is diagonal and never changes.
    rows : tuple of ndarray
        Quantities whose peaks are kept, over the unknowns.
    row_inputs : ndarray, shape (n_rows, n_inputs)
    row_constants : ndarray, shape (n_rows,)
    reactions : ndarray, shape (3, n_moved, n)
        Of moved supports from displacements, velocities, accelerations; empty with one motion for the base.
    supports : ndarray, shape (2, n_moved, n_inputs)
        Reactions from the inputs, and the supports' velocities.
    support_c : ndarray, shape (n_moved, n_moved)
    """

    k: Product
    c: Product
    m: Product
    inputs: Array
    pushed: Array
    constant: Array
    pattern: Pattern
    a: Array
    column: Index
    heavy: Flags
    inert: bool
    shifts: bool
    instant: float
    implicit: bool
    diagonal: bool
    explicit: bool
    rows: tuple[Index, Place, Array]
    row_inputs: Array
    row_constants: Array
    reactions: Array
    supports: Array
    support_c: Array


class Turning(NamedTuple):
    """Members whose forces follow their displaced line (see `corotational`).

    Attributes
    ----------
    p : ndarray, shape (n_chords, 10)
    at : ndarray, shape (n_chords + 1,)
        Pointers into the unknowns that each touches.
    unknown : ndarray, shape (n_touched,)
    rows : ndarray, shape (n_touched, 6)
        Their share in the six quantities.
    pairs : ndarray, shape (n_chords + 1,)
        Pointers into the pairs of unknowns.
    pair : ndarray, shape (n_pairs, 3)
        Position in the pattern of A, and the two touched ones.
    inputs : ndarray, shape (n_chords, 6, n_inputs)
    supports : ndarray, shape (n_chords, 6, n_moved)
    s : ndarray, shape (n_chords, 36)
        Columns as above.
    h : ndarray, shape (2 n_chords, 36)
        Tangents: those in the factor, those of the present.
    product : ndarray, shape (most touched, 6)
        Scratch.
    most : ndarray, shape (1,)
        Largest force so far.
    """

    p: Array
    at: Index
    unknown: Index
    rows: Array
    pairs: Index
    pair: Index
    inputs: Array
    supports: Array
    s: Array
    h: Array
    product: Array
    most: Array


class Laws(NamedTuple):
    """The laws: what they are, and the state they are in.

    Attributes
    ----------
    rows : tuple of ndarray
        Their deformations over the unknowns.
    inputs : ndarray, shape (n_laws, n_inputs)
    pairs : tuple of ndarray
        Where each law's ``b b^T`` adds to A: pointers, positions in its pattern, products.
    supports : ndarray, shape (n_laws, n_moved)
    p : ndarray, shape (n_laws, PARAMETERS)
    memory : ndarray, shape (n_laws, VARIABLES + 2)
    f, i : ndarray, shapes (n_laws, 27), (n_laws, 9)
        Columns as above.
    saved : ndarray, shape (n_laws, 5 + VARIABLES)
        State at the start of a step that is not cut at events.
    leans : ndarray, shape (n_leaning,)
        The laws that lean on another, which comes before them.
    corotational : Turning
    """

    rows: tuple[Index, Place, Array]
    inputs: Array
    pairs: tuple[Index, Place, Array]
    supports: Array
    p: Array
    memory: Array
    f: Array
    i: Index
    saved: Array
    leans: Index
    corotational: Turning


class Motion(NamedTuple):
    """The motion, and scratch space.

    Attributes
    ----------
    q : ndarray, shape (19, n)
        Rows as above; `W` is zero between uses.
    l : ndarray, shape (4, n_entries of L)
        Factors for the nominal step, for a piece of one, of M (with ones for massless unknowns), and of
        ``K + C / e``, e a tiny time, over the massless unknowns (with ones for the others).
    ax : ndarray
        Values of A.
    peak : ndarray, shape (6, n_rows + 2 n_laws)
        Of the rows, the deformations and the forces.
    works : ndarray, shape (4,)
        Work put in; lost in the structure's, in the contacts' dashpots; sum of all \\|input\\|.
    inputs : ndarray, shape (4, n_inputs)
        The motions and their rates, at the start and at the end of a step.
    """

    q: Array
    l: Array  # noqa: E741
    ax: Array
    peak: Array
    works: Array
    inputs: Array


class Samples(NamedTuple):
    """What is kept until Python fetches it.

    Attributes
    ----------
    motion : ndarray, shape (n_samples, 3, n)
    laws : ndarray, shape (n_samples, 3, n_laws)
        Forces, recoverable and lost energies.
    works : ndarray, shape (n_samples, 4)
        Time, and the first three works.
    log : ndarray, shape (n_log, COLUMNS)
    which : ndarray, shape (n_which,)
        Unknowns that the envelopes look at.
    shown : ndarray, shape (n_shown, 3, n_which)
        The motion between the samples.
    when : ndarray, shape (n_shown,)
        Its times.
    """

    motion: Array
    laws: Array
    works: Array
    log: Array
    which: Index
    shown: Array
    when: Array


class Scheme(NamedTuple):
    """Parameters of the method, and whether events are located."""

    beta: float
    gamma: float
    alpha_m: float = 0.0
    alpha_f: float = 0.0
    locate: bool = True
