r"""Rigid contacts in a power series: kernels, and the arrays they work on.

While contacts are closed, forces r, which are a separate series, keep their deformations at the gaps.  With
the coefficient k of the motion without them, and the rows B, the inverse masses and
:math:`G = B M^{-1} B^T` of `rigid.contacts`,

.. math:: G\,x_k = B c_k + B_s s_k - g\,\delta_{k0}, \qquad c_k \leftarrow c_k - M^{-1} B^T x_k, \qquad
          r_{k-2} = \frac{k(k-1)}{h^2}\, x_k

:math:`B_s s_k` being the part of the inputs and g the gaps.  The first two coefficients, which are the
present state, are corrected for rounding in this way in every step.  A contact parts where its force drops
to zero.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.allocation import inverse_index
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.rigid.contacts import RigidContacts
from pound_solve.integrate.series.springs import deformation_term
from pound_solve.integrate.series.state import Rigid, Series
from pound_solve.numerics.types import Flags, Index


def allocate(contacts: RigidContacts, order: Index, n_laws: int, n_coefs: int) -> Rigid:
    """Lay out the rigid contacts for series of `n_coefs` coefficients, the unknowns in an `order`."""
    n, laws = len(contacts.laws), np.array(contacts.laws, np.int64)
    return Rigid(
        laws=laws,
        index_of=inverse_index(laws, n_laws),
        gap=contacts.gap,
        velocity_change=np.ascontiguousarray(contacts.velocity_change[order].T),
        closed=np.zeros(n, np.int64),
        n_closed=np.zeros(1, np.int64),
        is_closed=np.zeros(n, bool),
        inverse=np.zeros((n, n)),
        violation=np.zeros(n),
        force=np.zeros((n, n_coefs)),
        largest=np.zeros(n),
    )


def set_closed_contacts(rigid: Rigid, contacts: RigidContacts, closed: Flags) -> None:
    """Set which contacts are closed, and the inverse matrix for their forces."""
    at = np.flatnonzero(closed)
    rigid.is_closed[:], rigid.n_closed[0], rigid.closed[: len(at)] = closed, len(at), at
    rigid.inverse[: len(at), : len(at)] = contacts.inverse(at)
    rigid.force[:] = 0.0


def is_closed(rigid: Rigid, law: int) -> bool:
    """Return whether a law is a rigid contact that is closed."""
    return bool(rigid.index_of[law] >= 0 and rigid.is_closed[rigid.index_of[law]])


def hold_contacts(laws: Laws, series: Series, k: int, h: float, n_powers: int) -> None:
    """Correct the coefficients `k` of the unknowns with mass so that closed contacts stay closed."""
    rigid, c = series.rigid, series.motion[k]
    n = rigid.n_closed[0]
    for q in range(n):
        r = rigid.closed[q]
        off = deformation_term(laws.definition, series, k, n_powers, rigid.laws[r])
        rigid.violation[q] = off - rigid.gap[r] if k == 0 else off
    for q in range(n):
        r, x = rigid.closed[q], 0.0
        for p in range(n):
            x += rigid.inverse[q, p] * rigid.violation[p]
        for i in range(len(c)):
            c[i] -= rigid.velocity_change[r, i] * x
        if k >= 2:
            rigid.force[r, k - 2] = x * (k * (k - 1)) / (h * h)
