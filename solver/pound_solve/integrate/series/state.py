"""State of the kernels of TAYLOR, beside the arrays that all kernels share."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from pound_solve.integrate.kernels.sparse import Product, Rows
from pound_solve.numerics.ldl import Pattern, Positions
from pound_solve.numerics.types import Array, Flags, Index


class StepControl(Protocol):
    """Control of the step length, and counts of a run: a numpy record."""

    next_length: float  #: length to try next
    largest_kinetic: float  #: largest value of v M v so far
    shortest_length: float  #: length of the shortest step
    farthest: float  #: largest displacement of the bodies of any contact so far
    length_before_contact: float  #: `next_length` when a power contact began to press; 0 if none did
    quadrature_degree: int  #: degree of the present series that still carries energy, for Gauss's rule
    n_modal_intervals: int  #: intervals that were advanced in modes
    n_factorisations: int  #: of the matrix of a step
    n_rejected: int  #: steps that were taken again, shorter


class AssembledSprings(NamedTuple):
    """The laws on their present branches, added up over the unknowns (see `springs`).

    Attributes
    ----------
    row : ndarray, shape (n_rows,)
        Unknowns that laws hold; all unknowns, if some have no mass.
    index_of : ndarray, shape (n,)
        Index of each unknown in `row`, -1 for the others.
    rows : Rows
        Sum of ``k b b^T`` in these rows, plus K if some unknowns have no mass.
    stiffness : ndarray, shape (n_entries,)
        K in these rows, zero where all have mass.
    pair_pointers, pair_places, pair_values : ndarray
        Positions in `rows` at which the product ``b b^T`` of each law is added, and its values.
    constant : ndarray, shape (n,)
        Constant loads less the constant forces of the laws.
    inputs : ndarray, shape (n_inputs, n)
        Loads of unit inputs, less the forces of laws at supports that these move.
    dashpots : ndarray, shape (n_laws,)
        Laws with a dashpot, the first `n_dashpots`.
    n_dashpots : ndarray, shape (1,)
        A cell that kernels write.
    """

    row: Positions
    index_of: Index
    rows: Rows
    stiffness: Array
    pair_pointers: Positions
    pair_places: Positions
    pair_values: Array
    constant: Array
    inputs: Array
    dashpots: Index
    n_dashpots: Index


class Massless(NamedTuple):
    """The massless unknowns, numbered among themselves, and the laws that hold them.

    Attributes
    ----------
    unknown : ndarray, shape (n_massless,)
        Their indices in the order of elimination.
    with_mass : ndarray, shape (n - n_massless,)
        Indices of the unknowns with mass.
    damping, damping_with_mass : Rows
        Rows of C over all unknowns, for the massless unknowns and for those with mass.
    laws : ndarray, shape (n_holding,)
        Laws that hold a massless unknown, ascending.
    index_of_law : ndarray, shape (n_laws,)
        Index of each law in `laws`, -1 for the others.
    rows : Rows
        Deformations of these laws over the massless unknowns.
    pattern : Pattern
        Pattern of C and K over the massless unknowns, laws included.
    column : ndarray, shape (n_entries,)
    on_pattern : ndarray, shape (2, n_entries)
        C and K on the pattern, without those of laws.
    pair_pointers, pair_places, pair_values : ndarray
        Positions on the pattern at which each of the laws is added, and the values of ``b b^T``.
    damped : ndarray, shape (n_massless,)
        Whether a dashpot resists an unknown on the present branches: its order is one, else zero.
    unknowns_of_order : ndarray, shape (2, n_massless)
        Rows `ORDER_ONE` and `ORDER_ZERO`: the unknowns of that order, ascending.
    n_of_order : ndarray, shape (2,)
        Numbers of these.
    factors : ndarray, shape (2, n_entries of L)
        Rows `ORDER_ONE` and `ORDER_ZERO`; unknowns of the other order have unit rows.
    inverse_pivots : ndarray, shape (2, n_massless)
        One over their pivots.
    failed_pivot : ndarray, shape (1,)
        Pivot by which the last factorisation failed: a cell that kernels write.
    matrix : ndarray, shape (n_entries,)
        Scratch, as the others.
    row, right_side : ndarray, shape (n_massless,)
    elastic : ndarray, shape (n_massless,)
        Diagonal of K with elastic laws, for energies from displacements.
    """

    unknown: Index
    with_mass: Index
    damping: Rows
    damping_with_mass: Rows
    laws: Index
    index_of_law: Index
    rows: Rows
    pattern: Pattern
    column: Index
    on_pattern: Array
    pair_pointers: Positions
    pair_places: Positions
    pair_values: Array
    damped: Flags
    unknowns_of_order: Index
    n_of_order: Index
    factors: Array
    inverse_pivots: Array
    failed_pivot: Array
    matrix: Array
    row: Array
    right_side: Array
    elastic: Array


class Rigid(NamedTuple):
    """The rigid contacts, numbered among themselves (see `rigid`).

    Attributes
    ----------
    laws : ndarray, shape (n_rigid,)
    index_of : ndarray, shape (n_laws,)
        Index of each law in `laws`, -1 for the others.
    gap : ndarray, shape (n_rigid,)
    velocity_change : ndarray, shape (n_rigid, n)
        Change of the velocities for unit impulses.
    closed : ndarray, shape (n_rigid,)
        The closed contacts, in the first `n_closed` places.
    n_closed : ndarray, shape (1,)
        A cell, which is written as contacts close and part.
    is_closed : ndarray, shape (n_rigid,)
    inverse : ndarray, shape (n_rigid, n_rigid)
        Inverse of G over the closed contacts `closed`.
    violation : ndarray, shape (n_rigid,)
        Scratch: violation of the constraints by the present coefficients, by place in `closed`.
    force : ndarray, shape (n_rigid, MAX_DEGREE + 1)
        Coefficients of the forces.
    largest : ndarray, shape (n_rigid,)
        Largest magnitude of the force, or of its terms, so far.
    """

    laws: Index
    index_of: Index
    gap: Array
    velocity_change: Array
    closed: Index
    n_closed: Index
    is_closed: Flags
    inverse: Array
    violation: Array
    force: Array
    largest: Array


class PowerContacts(NamedTuple):
    """The power contacts, numbered among themselves (see `power_contacts`).

    Attributes
    ----------
    laws : ndarray, shape (n_curved,)
    index_of : ndarray, shape (n_laws,)
        Index of each law in `laws`, -1 for the others.
    constants : ndarray, shape (n_curved, 6)
        Numbers that `Rule.power_law` returns on the present branch.
    phase : ndarray, shape (n_curved,)
        APART, PRESSED or FORCE_FREE, see `power_contacts`: whether a force acts.
    overlap_powers : ndarray, shape (n_curved, 2, MAX_DEGREE + 1)
        Coefficients of the powers of the overlap, of spring and dashpot.
    force : ndarray, shape (n_curved, MAX_DEGREE + 1)
        Coefficients of the forces.
    largest : ndarray, shape (n_curved,)
        Largest force so far.
    """

    laws: Index
    index_of: Index
    constants: Array
    phase: Index
    overlap_powers: Array
    force: Array
    largest: Array


class Friction(NamedTuple):
    """The friction laws of contacts, numbered among themselves (see `friction`).

    Attributes
    ----------
    laws : ndarray, shape (n_friction,)
    index_of : ndarray, shape (n_laws,)
        Index of each law in `laws`, -1 for the others.
    normal : ndarray, shape (n_friction,)
        The laws of the contacts.
    sliding_direction : ndarray, shape (n_friction,)
        Direction of sliding, 1 or -1; 0 if it does not slide.
    pressing : ndarray, shape (n_friction,)
        Whether the contact presses; a sticky one may pull.
    normal_force : ndarray, shape (n_friction, MAX_DEGREE + 1)
        Coefficients of the normal forces.
    force : ndarray, shape (n_friction, MAX_DEGREE + 1)
        Coefficients of the forces of friction that slides.
    largest : ndarray, shape (n_friction,)
        Largest normal force so far.
    """

    laws: Index
    index_of: Index
    normal: Index
    sliding_direction: Array
    pressing: Flags
    normal_force: Array
    force: Array
    largest: Array


class Smooth(NamedTuple):
    """The smooth laws, numbered among themselves (see `smooth`).

    Attributes
    ----------
    laws : ndarray, shape (n_smooth,)
    index_of : ndarray, shape (n_laws,)
        Index of each law in `laws`, -1 for the others.
    constants : ndarray, shape (n_smooth, 7)
        w, y, n, a, b and q of `Rule.smooth_curve`, and dw/dd, at the start of the step.
    bent : ndarray, shape (n_smooth,)
        Whether the power is not negligible.
    low, high : ndarray, shape (n_smooth,)
        Range of w/y in which the series is valid.
    ratio : ndarray, shape (n_smooth, 2 MAX_POWER_BITS, MAX_DEGREE + 1)
        Coefficients of w/y, and of its powers on the way to n.
    ratio_power, w, remainder, force : ndarray, shape (n_smooth, MAX_DEGREE + 1)
        Coefficients of p and w, of the part of w beyond the tangent, and of the forces.
    """

    laws: Index
    index_of: Index
    constants: Array
    bent: Flags
    low: Array
    high: Array
    ratio: Array
    ratio_power: Array
    w: Array
    remainder: Array
    force: Array


class PowerDampers(NamedTuple):
    """The dampers that follow powers of the rate, numbered among themselves (see `power_dampers`).

    Attributes
    ----------
    laws : ndarray, shape (n_viscous,)
    index_of : ndarray, shape (n_laws,)
        Index of each law in `laws`, -1 for the others.
    constants : ndarray, shape (n_viscous, 4)
        c, with the sign of the rate, and n; rate up to which the force is linear; rate of the tangent.
    on_massless : ndarray
        Dampers that hold massless unknowns.
    is_series : ndarray, shape (n_viscous,)
        Whether the force is a series.
    rate, remainder, force : ndarray, shape (n_viscous, MAX_DEGREE + 1)
        Coefficients of the rate's magnitude, of the force beyond the tangent, and of the force.
    """

    laws: Index
    index_of: Index
    constants: Array
    on_massless: Index
    is_series: Flags
    rate: Array
    remainder: Array
    force: Array


class PDeltaMembers(NamedTuple):
    """The members with P-Delta by the present axial force (see `p_delta`).

    Attributes
    ----------
    axial, across, force : ndarray, shape (n_members, MAX_DEGREE + 1)
        Coefficients of the axial forces, the displacements across and the forces there.
    """

    axial: Array
    across: Array
    force: Array


class Damped(NamedTuple):
    """The unknowns that the structure's dashpots act on.

    Attributes
    ----------
    unknown : ndarray, shape (n_damped,)
    damping : Product
        C among them.
    motion : ndarray, shape (MAX_DEGREE + 1, n_damped)
        Scratch: their coefficients, their velocities and the forces on them.
    velocity, force : ndarray, shape (n_damped,)
    """

    unknown: Index
    damping: Product
    motion: Array
    velocity: Array
    force: Array


class Modal(NamedTuple):
    """Parts of the structure in modes, with tables for one length of interval (see `modal_tables`).

    Parts come one after the other along the first axis, padded to the size of the largest; x has
    `2 n_modes + 2 n_inputs` numbers.

    Attributes
    ----------
    length : float
        Length of the interval; 0 where there are no tables.
    is_present : ndarray, shape (1,)
        Whether the present motion is in `modes`: a cell that kernels write.
    is_valid : ndarray, shape (1,)
        Whether the laws are on branches as stiff as those of the tables: a cell that kernels write.
    stiffness : ndarray, shape (n_laws,)
        Stiffness of the laws in the tables.
    counts : ndarray, shape (n_parts, 4)
        Numbers of unknowns, modes, followed quantities, and unknowns that envelopes need.
    unknowns : ndarray, shape (n_parts, n)
        Their places in the order of elimination.
    to_modes, from_modes : ndarray, shape (n_parts, 2, 2 n_modes, n) and (n_parts, 2, n, 2 n_modes)
        Real, then imaginary parts of the modes from displacements and velocities, and these from them.
    static_positions : ndarray, shape (n_parts, 2 n_modes, n)
        Static positions of the modes under unit constant loads.
    exponentials : ndarray, shape (n_parts, 2 n_cells + 1, 2, n_modes)
        Real and imaginary parts of the free modes' factors at the ends and the middles of the cells.
    particular_solution : ndarray, shape (n_parts, 2 n_modes, 2 n_inputs)
        Particular solution of the modes, a straight line in time: its start on the interval's inputs.
    chord_error_factor : ndarray, shape (n_parts, n_modes)
        Distance of a free mode of size one from its chord over a cell, at most.
    followed : ndarray, shape (n_parts, n_followed)
        Numbers of what is followed: deformations of the laws, then monitored outputs.
    index_of : ndarray, shape (n_parts, n_all_followed)
        Index of each followed quantity in a part, -1 for the others.
    exponent_per_cell : ndarray, shape (n_parts, 2, n_modes)
        Real and imaginary parts of the eigenvalues times the length of a cell.
    amplitude : ndarray, shape (n_parts, n_followed, n_modes)
        Largest contribution of each mode of size one to each followed quantity.
    rows : ndarray, shape (n_parts, n_followed, n_x)
        Rows that give the followed quantities from x.
    damping_work, input_work, constant_work : ndarray
        Works over the interval on x, shape (n_parts, n_x, n_x), (n_parts, 2 n_inputs, n_x), (n_parts, n_x).
    enveloped : ndarray, shape (n_parts, n_enveloped)
        Numbers of the unknowns that envelopes need.
    motion : ndarray, shape (n_parts, 3, n_enveloped, n_x)
        Their displacements, velocities and accelerations on x.
    modes, equilibrium : ndarray, shape (n_parts, 2 n_modes)
        Modal coordinates, and their static position under the present constant loads.
    offset : ndarray, shape (n_followed,)
        Values of the followed quantities in that static position.
    x, mode_chord_error, term, values, chord_error : ndarray
        Scratch: x of every part at the ends and middles of the cells; distance of its free modes from
        chords; what they add to a term; the followed quantities at the ends of the cells, shape
        (n_cells + 1, n_all_followed), and their distance from chords.
    """

    length: float
    is_present: Index
    is_valid: Index
    stiffness: Array
    counts: Index
    unknowns: Index
    to_modes: Array
    from_modes: Array
    static_positions: Array
    exponentials: Array
    particular_solution: Array
    chord_error_factor: Array
    followed: Index
    index_of: Index
    exponent_per_cell: Array
    amplitude: Array
    rows: Array
    damping_work: Array
    input_work: Array
    constant_work: Array
    enveloped: Index
    motion: Array
    modes: Array
    equilibrium: Array
    offset: Array
    x: Array
    mode_chord_error: Array
    term: Array
    values: Array
    chord_error: Array


class EnvelopeBuffers(NamedTuple):
    """Motion of steps and of intervals in modes that is kept for the envelopes (see `envelope_buffers`).

    Attributes
    ----------
    is_needed : bool
        Whether the envelopes need any motion.
    unknowns, laws : ndarray
        Unknowns, by their indices in the order of elimination, and laws.
    kept : ndarray, shape (2,)
        Steps and intervals that were kept.
    coefs : ndarray, shape (n_steps, n_unknowns + n_laws, MAX_DEGREE + 1)
        Series of the unknowns and of the forces of the laws, all dashpots included, over the steps taken.
    degree : ndarray, shape (n_steps,)
        Their highest powers; all others are zero.
    begin, length : ndarray, shape (n_steps,)
        Time of the start, and to where the step was taken.
    x, equilibrium : ndarray, shape (n_intervals, n_parts, n_x) and (n_intervals, n_parts, 2 n_modes)
        `Modal.x` and `Modal.equilibrium` at their starts.
    constant_forces : ndarray, shape (n_intervals, n_laws)
        Forces of the laws at the static positions of the modes.
    start : ndarray, shape (n_intervals,)
        Times.
    """

    is_needed: bool
    unknowns: Index
    laws: Index
    kept: Index
    coefs: Array
    degree: Index
    begin: Array
    length: Array
    x: Array
    equilibrium: Array
    constant_forces: Array
    start: Array


class SinglePole(NamedTuple):
    """Laguerre series of a step, with one pole gamma (see `single_pole`); empty for power series.

    Attributes
    ----------
    basis : ndarray, shape (s + 1, s + 1)
        Powers of the place in each polynomial.
    monomials : ndarray, shape (s + 1, s + 1)
        Polynomials in each power.
    gamma : float
    allowed : float
        Largest energy of the last term, as a fraction of that of the motion.
    displacement, velocity : ndarray, shape (s + 1, n)
        Coefficients of the unknowns.
    inputs : ndarray, shape (s + 2, n_inputs)
        Coefficients of the inputs.
    decrement : ndarray, shape (n,)
        Scratch: decrease from the coefficients of the velocities to the next ones.
    velocity_defect : ndarray, shape (n,)
        Scratch: present velocities less those with which the truncated series begins, times the step.
    initial_slope : ndarray, shape (s + 1,)
        Powers of the place in a polynomial of slope one at 0, that is zero there and, with its slope, at 1.
    """

    basis: Array
    monomials: Array
    gamma: float
    allowed: float
    displacement: Array
    velocity: Array
    inputs: Array
    decrement: Array
    velocity_defect: Array
    initial_slope: Array


class Extent(NamedTuple):
    """The part of a step over which the series of its start holds.

    Attributes
    ----------
    begin : float
        Time at the start of the step.
    h : float
        Length of the step.
    degree : int
        Highest power of the series.
    end : float
        Place up to which the step is taken or searched, in lengths of the step.
    """

    begin: float
    h: float
    degree: int
    end: float


class Series(NamedTuple):
    """The series of a step.

    Attributes
    ----------
    motion : ndarray, shape (MAX_DEGREE + 1, n)
        Coefficients of the unknowns in powers of s = t / h, with the length h for which `begin_series` was
        called last (1 in `settle_state`); those of deformations and inputs likewise.
    stiffness_product, damping_product, mass_product : ndarray, shape (n,)
        Scratch: products of coefficients with K (laws included), C and M.
    deformation : ndarray, shape (n_laws, MAX_DEGREE + 1)
        Coefficients of the deformations of the laws.  The tables of modes use them as scratch: they are
        right from `expand_series` to the end of its step.
    inputs : ndarray, shape (MAX_DEGREE + 1, n_inputs)
    polynomial : ndarray, shape `polynomial_roots.room`
        Work space of `polynomial_roots`.
    inverse : ndarray, shape (n,)
        Inverse of a diagonal mass.
    gauss : ndarray, shape (MAX_DEGREE // UNCHECKED_TERMS + 1, 2, most points)
        Weights and points on (0, 1), two more than half of the terms that carry energy.
    springs : AssembledSprings
    massless : Massless
    rigid : Rigid
    power_contacts : PowerContacts
    friction : Friction
    smooth : Smooth
    power_dampers : PowerDampers
    p_delta : PDeltaMembers
    damped : Damped
    modal : Modal
    envelope : EnvelopeBuffers
    single_pole : SinglePole
    control : StepControl
    """

    motion: Array
    stiffness_product: Array
    damping_product: Array
    mass_product: Array
    deformation: Array
    inputs: Array
    polynomial: Array
    inverse: Array
    gauss: Array
    springs: AssembledSprings
    massless: Massless
    rigid: Rigid
    power_contacts: PowerContacts
    friction: Friction
    smooth: Smooth
    power_dampers: PowerDampers
    p_delta: PDeltaMembers
    damped: Damped
    modal: Modal
    envelope: EnvelopeBuffers
    single_pole: SinglePole
    control: StepControl
