r"""The numbers from which a history is integrated, and their derivatives by parameters.

They are smooth functions of the parameters of a deck (most of them polynomials), and cost little beside a
history.  Their derivatives are therefore central differences of the assembled system, extrapolated
(one-sided ones of third order if the deck refuses smaller values of the parameter),

.. math:: \frac{dc}{dp} = \frac{4 D(h/2) - D(h)}{3} + O(h^4), \qquad D(h) = \frac{c(p + h) - c(p - h)}{2h} .

No card needs a formula for its derivative.  The response, which events make rough, is not differenced.

References
----------
Richardson LF (1911), The approximate arithmetical solution by finite differences of physical problems
involving differential equations, Phil. Trans. R. Soc. A 210: 307-357.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from pound_solve.analyses.history import drift_heights
from pound_solve.integrate.condensed import condensed as condensed_problem
from pound_solve.integrate.protocol import Problem
from pound_solve.numerics.matrices import dense
from pound_solve.numerics.types import Array
from pound_solve.sensitivity.case import Case
from pound_solve.sensitivity.measured import MeasuredRows, Places, measured
from pound_solve.sensitivity.refusal import NoDerivativeError
from pound_solve.structure.condensation import condense

STEP = 1e-3  #: of the differences, as a fraction of the parameter; of 1 for a parameter that is zero
#: places of a difference in steps, and their weights: extrapolated, and one-sided at a limit
CENTRAL = (-1.0, 1.0 / 6.0), (-0.5, -4.0 / 3.0), (0.5, 4.0 / 3.0), (1.0, -1.0 / 6.0)
FORWARD = (1.0, 3.0), (2.0, -1.5), (3.0, 1.0 / 3.0)  # besides that of the place itself


class Coefficients(NamedTuple):
    """Numbers of a history without its condensed unknowns (see `ReducedSystem`, `Condensed`).  As their
    derivatives, each has a leading axis over the parameters.

    Attributes
    ----------
    mass, damping, stiffness : ndarray, shape (n, n)
    inputs : ndarray, shape (n, n_inputs)
    constant : ndarray, shape (n,)
    law_rows : ndarray, shape (n_laws, n)
    law_inputs : ndarray, shape (n_laws, n_inputs)
    excitation : ndarray, shape (n_pieces, degree + 1, n_inputs)
    u, v : ndarray, shape (n,)
        At the start.
    parameters, variables : ndarray, shape (n_laws, n_largest)
        Of the laws, the variables at the start; zeros after the last one.
    beta, secant : ndarray, shape (n_laws,)
    expand, follow, offset : ndarray, shape (n_all, n), (n_all, n_inputs), (n_all,)
        Give all unknowns.
    on_u, on_v, on_a, on_f, on_s, of_one : ndarray
        Rows of the measured quantities over all unknowns.
    heights : ndarray, shape (n_drifts,)
    yields, beside : ndarray, shape (n_laws, 2), (n_laws,)
        NaN for a side that does not yield.
    periods : ndarray, shape (n_modes,)
        Of MODAL.
    """

    mass: Array
    damping: Array
    stiffness: Array
    inputs: Array
    constant: Array
    law_rows: Array
    law_inputs: Array
    excitation: Array
    u: Array
    v: Array
    parameters: Array
    variables: Array
    beta: Array
    secant: Array
    expand: Array
    follow: Array
    offset: Array
    on_u: Array
    on_v: Array
    on_a: Array
    on_f: Array
    on_s: Array
    of_one: Array
    heights: Array
    yields: Array
    beside: Array
    periods: Array

    @property
    def rows(self) -> MeasuredRows:
        """Return the rows of the measured quantities."""
        return MeasuredRows(self.on_u, self.on_v, self.on_a, self.on_f, self.on_s, self.of_one)


def coefficients(case: Case) -> tuple[Coefficients, Places]:
    """Return the numbers of a case, and the places of its measured quantities."""
    small, problem = condense(case.problem.system), condensed_problem(case.problem, "EXACT")
    system, start, laws = problem.system, problem.start, problem.system.structure.laws
    rows, places = measured(case.items)
    model = system.structure.model
    values = Coefficients(
        mass=system.mass,
        damping=system.damping,
        stiffness=system.stiffness,
        inputs=system.inputs,
        constant=system.constant,
        law_rows=dense(system.law_rows),
        law_inputs=system.law_inputs,
        excitation=system.excitation.coefs,
        u=start.u,
        v=start.v,
        parameters=_padded([s.law.p for s in laws]),
        variables=_padded([x[3] for x in start.states]),
        beta=np.array([s.beta for s in laws]),
        secant=np.array([s.secant for s in laws]),
        expand=small.expand,
        follow=small.follow,
        offset=small.constant,
        on_u=rows.on_u,
        on_v=rows.on_v,
        on_a=rows.on_a,
        on_f=rows.on_f,
        on_s=rows.on_s,
        of_one=rows.constant,
        heights=np.array(list(drift_heights(model))),
        yields=np.array([s.yields or (np.nan, np.nan) for s in laws]).reshape(-1, 2),
        beside=np.array([s.beside for s in laws]),
        periods=np.array(case.periods),
    )
    return values, places


def _padded(rows: list[tuple[float, ...]]) -> Array:
    """Return rows of different lengths as one array, filled up with zeros."""
    padded = np.zeros((len(rows), max(map(len, rows), default=0)))
    for x, row in zip(padded, rows):
        x[: len(row)] = row
    return padded


def shape_of(case: Case) -> tuple[object, ...]:
    """Return what has to be the same for differences between two cases: the unknowns, the laws, the
    branches at the start, and the times of the excitation.
    """
    problem: Problem = case.problem  # type: ignore[type-arg]
    system = problem.system
    keep = condense(system).keep
    return (
        system.dofs,
        tuple(keep.tolist()),
        tuple((s.element, s.component, s.rule) for s in system.structure.laws),
        tuple(x[0] for x in problem.start.states),
        tuple(system.excitation.breaks.tolist()),
        tuple(problem.start.times.tolist()),
        len(case.periods),
    )


def derivative(
    at: Callable[[float], Case], value: float, name: str, middle: Case, base: Coefficients
) -> Coefficients:
    """Return the derivatives of the numbers by one parameter.

    Parameters
    ----------
    at : callable
        Returns the case of a value of the parameter.
    value : float
        Of the parameter.
    name : str
        Of the parameter.
    middle : Case
        At this value.
    base : Coefficients
        Its numbers.

    Raises
    ------
    NoDerivativeError
        The structure or the times of the excitation change with the parameter.
    """
    h = STEP * (abs(value) or 1.0)
    try:
        terms = [(at(value + share * h), weight) for share, weight in CENTRAL]
    except NoDerivativeError:  # the parameter may be at its lower limit
        terms = [(at(value + share * h), weight) for share, weight in FORWARD]
    if any(shape_of(case) != shape_of(middle) for case, _ in terms):
        raise NoDerivativeError(
            f"{name} changes more than numbers: the unknowns, the laws, their branches at the start or "
            "the times of the excitation"
        )
    each = [
        [weight / h * _change(x, y) for x, y in zip(coefficients(case)[0], base)] for case, weight in terms
    ]
    return Coefficients(*(np.sum(x, axis=0) for x in zip(*each)))


def _change(x: Array, y: Array) -> Array:
    """Return ``x - y``, exactly zero where both are equal, even if infinite."""
    return np.subtract(x, y, out=np.zeros_like(x), where=x != y)
