r"""Corotational geometry: the terms that a member's displaced chord adds to its linear stiffness.

The chord of a member runs from one end of its flexible length to the other.  Linear theory makes the
deformations of the beam :math:`e = (\text{elongation}, \theta_I, \theta_J)`, the rotations relative to the
chord, linear in the displacements, :math:`e = Bu`.  With the true length and rotation of the chord they are

.. math:: e = B u + D z, \qquad z = (\eta, \rho), \qquad
          \eta = \ell - L - x, \qquad \rho = \alpha - \psi

(the corotational member, Crisfield 1991): the length :math:`\ell` and rotation :math:`\alpha` less their
values in linear theory.  Rotations in the plane add, so hinges and joints stay linear. z depends on four
numbers only, the displacements x along and y across that J has beyond I and the rotations of both nodes
(which rotate the rigid end blocks).  With the linear beam :math:`k` the member's energy is its linear part
and the *potential*

.. math:: V = (n + n_0)\,\eta + (t + t_0)\,\rho + \tfrac12 z^T k_z z, \qquad
          \begin{pmatrix} n \\ t \end{pmatrix} = D^T k B u, \qquad k_z = D^T k D

with the linear axial force n and the sum of the end moments -t, and what initial forces add.  V depends on
the six *quantities* :math:`s = (n, t, x, y, r_I, r_J)`, linear in u; its gradient is the forces on
them, its Hessian their stiffness.

The other kind is the string of P-Delta with the present axial force: :math:`(n + n_0)\,y/L` across the
member and nothing else.  These forces have no potential, because the shortening y^2/2L of the chord, along
which the axial force would do work, is left out.

References
----------
Crisfield MA (1991), Non-linear Finite Element Analysis of Solids and Structures, vol. 1, Wiley, chapter 7.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from pound_solve.numerics.matrices import Matrix, by_rows, gathered
from pound_solve.numerics.providers import provider
from pound_solve.numerics.types import Array, Index
from pound_solve.structure.dofs import Dof

QUANTITIES = 6
#: columns of the quantities n, t, x, y, r_I and r_J
AXIAL, END_MOMENT, ALONG, ACROSS, ROTATION_I, ROTATION_J = range(QUANTITIES)
#: columns of the parameters; KNN, KNT, KTT are k_z, SHARE_I the weight of I's rotation in the member's
KIND, LENGTH, END1, END2, SHARE_I, KNN, KNT, KTT, N0, T0 = range(10)
STRING, COROTATIONAL = 0.0, 1.0  #: kinds


@dataclass(frozen=True)
class CorotationalMember:
    """Chord and parameters of one member.

    Attributes
    ----------
    rows : ndarray, shape (6, n)
        The quantities over `DOFs`.
    p : tuple of float
        Parameters, columns as above.
    forces : mapping of str to ndarray, shape (3,)
        Share of :math:`\\eta`, :math:`\\rho` and the shear from the chord's change of length in the
        member's outputs, by quantity.
    """

    element: int
    dofs: tuple[Dof, ...]
    rows: Array
    p: tuple[float, ...]
    forces: Mapping[str, Array] = field(default_factory=dict)


def chord_geometry(p: Array, c: int, s: Array, at: int) -> tuple[float, float, float, float, float]:
    """Length, cosine and sine of the rotation, eta and rho of the chord of member `c`, whose quantities are
    in row `c` of `s` from column `at` on.
    """
    length, end1, end2 = p[c, LENGTH], p[c, END1], p[c, END2]
    x, y = s[c, at + ALONG], s[c, at + ACROSS]
    ri, rj = s[c, at + ROTATION_I], s[c, at + ROTATION_J]
    shrunk = 2.0 * (end1 * math.sin(0.5 * ri) ** 2 + end2 * math.sin(0.5 * rj) ** 2)  # rotated end blocks
    flat = length + x
    dx, dy = flat + shrunk, y - end1 * math.sin(ri) - end2 * math.sin(rj)
    now = math.sqrt(dx * dx + dy * dy)
    if flat > 0.0:  # avoids the difference of two lengths
        eta = (shrunk * (dx + flat) + dy * dy) / (now + flat)
    else:
        eta = now - flat
    turn = math.atan2(dy, dx)
    mean = p[c, SHARE_I] * ri + (1.0 - p[c, SHARE_I]) * rj
    # atan2 counts no full turns: add as many as the ends have made
    turn += 2.0 * math.pi * math.floor((mean - turn) / (2.0 * math.pi) + 0.5)
    return now, dx / now, dy / now, eta, turn - (y - end1 * ri - end2 * rj) / length


def quantity_forces(p: Array, c: int, s: Array, at: int, out: Array, to: int) -> None:
    """Forces on the quantities of member `c`, into row `c` of `out` from column `to` on."""
    if p[c, KIND] == STRING:
        for j in range(6):
            out[c, to + j] = 0.0
        out[c, to + ACROSS] = (s[c, at + AXIAL] + p[c, N0]) * s[c, at + ACROSS] / p[c, LENGTH]
        return
    now, co, si, eta, rho = chord_geometry(p, c, s, at)
    length, end1, end2 = p[c, LENGTH], p[c, END1], p[c, END2]
    n = s[c, at + AXIAL] + p[c, N0] + p[c, KNN] * eta + p[c, KNT] * rho
    t = s[c, at + END_MOMENT] + p[c, T0] + p[c, KNT] * eta + p[c, KTT] * rho
    ci, cj = math.cos(s[c, at + ROTATION_I]), math.cos(s[c, at + ROTATION_J])
    ti, tj = math.sin(s[c, at + ROTATION_I]), math.sin(s[c, at + ROTATION_J])
    over = t / now
    out[c, to + AXIAL] = eta
    out[c, to + END_MOMENT] = rho
    out[c, to + ALONG] = n * (co - 1.0) - over * si
    out[c, to + ACROSS] = n * si + over * co - t / length
    out[c, to + ROTATION_I] = end1 * (n * (co * ti - si * ci) - over * (si * ti + co * ci) + t / length)
    out[c, to + ROTATION_J] = end2 * (n * (co * tj - si * cj) - over * (si * tj + co * cj) + t / length)


def quantity_stiffness(p: Array, c: int, s: Array, at: int, h: Array, to: int) -> None:
    """Stiffness of the quantities of member `c`, 6 x 6, into row `to` of `h`.

    That of a string is without its unsymmetric part, the change of its force with n.
    """
    for j in range(36):
        h[to, j] = 0.0
    if p[c, KIND] == STRING:
        h[to, 6 * ACROSS + ACROSS] = (s[c, at + AXIAL] + p[c, N0]) / p[c, LENGTH]
        return
    now, co, si, eta, rho = chord_geometry(p, c, s, at)
    length, end1, end2 = p[c, LENGTH], p[c, END1], p[c, END2]
    knn, knt, ktt = p[c, KNN], p[c, KNT], p[c, KTT]
    n = s[c, at + AXIAL] + p[c, N0] + knn * eta + knt * rho
    t = s[c, at + END_MOMENT] + p[c, T0] + knt * eta + ktt * rho
    ci, cj = math.cos(s[c, at + ROTATION_I]), math.cos(s[c, at + ROTATION_J])
    ti, tj = math.sin(s[c, at + ROTATION_I]), math.sin(s[c, at + ROTATION_J])
    # along and across the chord: how its end moves with x, y and the rotations
    along = (co, si, end1 * (co * ti - si * ci), end2 * (co * tj - si * cj))
    across = (-si, co, -end1 * (si * ti + co * ci), -end2 * (si * tj + co * cj))
    linear = (0.0, 1.0 / length, -end1 / length, -end2 / length)
    first = (1.0, 0.0, 0.0, 0.0)
    for i in range(4):
        a, b = along[i] - first[i], across[i] / now - linear[i]
        row = 6 * (ALONG + i)  # first entry of the quantity's row; those of n and t are the same in columns
        h[to, 6 * AXIAL + ALONG + i] = h[to, row + AXIAL] = a
        h[to, 6 * END_MOMENT + ALONG + i] = h[to, row + END_MOMENT] = b
        for j in range(4):
            c2, d2 = along[j] - first[j], across[j] / now - linear[j]
            h[to, row + ALONG + j] = (
                n * across[i] * across[j] / now
                - t * (along[i] * across[j] + across[i] * along[j]) / (now * now)
                + knn * a * c2
                + knt * (a * d2 + b * c2)
                + ktt * b * d2
            )
    h[to, 7 * ROTATION_I] += end1 * (n * (co * ci + si * ti) + t / now * (co * ti - si * ci))
    h[to, 7 * ROTATION_J] += end2 * (n * (co * cj + si * tj) + t / now * (co * tj - si * cj))


def member_actions(p: Array, s: Array, out: Array) -> None:
    """Potential, eta, rho and shear from the chord's change of length of all members at several instants.

    Parameters
    ----------
    p : ndarray, shape (n_members, 10)
    s : ndarray, shape (n_times, n_members, 6)
    out : ndarray, shape (n_times, n_members, 4)
    """
    for i in range(s.shape[0]):
        for c in range(s.shape[1]):
            n, t = s[i, c, AXIAL] + p[c, N0], s[i, c, END_MOMENT] + p[c, T0]
            if p[c, KIND] == STRING:
                out[i, c, 0] = 0.5 * n * s[i, c, ACROSS] * s[i, c, ACROSS] / p[c, LENGTH]
                out[i, c, 1] = out[i, c, 2] = out[i, c, 3] = 0.0
                continue
            now, _, _, eta, rho = chord_geometry(p, c, s[i], 0)
            dn, dt = p[c, KNN] * eta + p[c, KNT] * rho, p[c, KNT] * eta + p[c, KTT] * rho
            out[i, c, 0] = (n + 0.5 * dn) * eta + (t + 0.5 * dt) * rho
            out[i, c, 1], out[i, c, 2] = eta, rho
            out[i, c, 3] = (t + dt) * (1.0 / p[c, LENGTH] - 1.0 / now)


def member_turning(p: Array, s: Array, out: Array) -> None:
    """Forces on the quantities of all members at several instants, see `quantity_forces`.

    Parameters
    ----------
    p : ndarray, shape (n_members, 10)
    s, out : ndarray, shape (n_times, n_members, 6)
    """
    for i in range(s.shape[0]):
        for c in range(s.shape[1]):
            quantity_forces(p, c, s[i], 0, out[i], 0)


class CorotationalMembers:
    """The members of a structure with corotational geometry or a P-Delta string.

    Parameters
    ----------
    members : sequence of CorotationalMember
    rows : Matrix, shape (6 n_members, n)
        Their quantities over the columns of the displacements, six rows for each.

    Attributes
    ----------
    p : ndarray, shape (n_members, 10)
    """

    def __init__(self, members: Sequence[CorotationalMember], rows: Matrix) -> None:
        self.members, self.rows = tuple(members), rows
        self.p = np.array([c.p for c in members]).reshape(len(members), 10)

    def __len__(self) -> int:
        return len(self.members)

    def on(self, columns: list[int] | slice) -> CorotationalMembers:
        """The same members over a subset of columns; the others stay at rest."""
        return CorotationalMembers(self.members, self.rows[:, columns])

    def quantities(self, u: Array) -> Array:
        """The six quantities of every member at displacements `u`, shape (n_members, 6)."""
        return np.asarray(self.rows @ u, float).reshape(-1, QUANTITIES)

    def touched(self) -> list[tuple[Index, Array]]:
        """Columns that each member depends on, ascending, and the rows of its quantities over them, (6,
        n_touched).
        """
        rows, by_member = by_rows(self.rows), []
        for c in range(len(self)):
            six = rows[QUANTITIES * c : QUANTITIES * (c + 1)]
            at = np.unique(np.concatenate([columns for columns, _ in six]))
            quantities = np.zeros((QUANTITIES, len(at)))
            for j, (columns, values) in enumerate(six):
                quantities[j, np.searchsorted(at, columns)] = values
            by_member.append((at, quantities))
        return by_member

    def forces(self, u: Array) -> Array:
        """Forces beyond those of the linear stiffness, shape (n,)."""
        forces = np.zeros((len(self), QUANTITIES))
        s = self.quantities(u)
        for c in range(len(self)):
            quantity_forces(self.p, c, s, 0, forces, 0)
        return np.asarray(forces.ravel() @ self.rows, float)

    def stiffness(self, u: Array) -> Matrix:
        """Tangent stiffness beyond the linear one, shape (n, n); see `quantity_stiffness`."""
        s, h = self.quantities(u), np.zeros((len(self), QUANTITIES**2))
        i, j, x = [np.zeros(0, int)], [np.zeros(0, int)], [np.zeros(0)]
        for c, (at, quantities) in enumerate(self.touched()):
            quantity_stiffness(self.p, c, s, 0, h, c)
            i.append(np.repeat(at, len(at)))
            j.append(np.tile(at, len(at)))
            x.append((quantities.T @ h[c].reshape(QUANTITIES, QUANTITIES) @ quantities).ravel())
        n = self.rows.shape[1]
        return gathered((n, n), np.concatenate(i), np.concatenate(j), np.concatenate(x))

    def actions(self, s: Array) -> Array:
        """`member_actions` at the quantities `s`, shape (n_times, n_members, 6)."""
        actions = np.zeros((*s.shape[:2], 4))
        provider().ready(member_actions)(self.p, np.ascontiguousarray(s), actions)
        return actions

    def turning(self, s: Array, members: Index) -> Array:
        """Forces by `member_turning` of some members at their quantities `s`, shape (n_times, n_members,
        6).
        """
        turning = np.zeros(s.shape)
        provider().ready(member_turning)(self.p[members], np.ascontiguousarray(s), turning)
        return turning

    def shares(self, outputs: Sequence[tuple[int, str]]) -> tuple[Index, Array]:
        """For each of some outputs (element, quantity): its member, and the factors of eta, rho and shear
        in it, shapes (n,) and (n, 3).
        """
        place = {c.element: i for i, c in enumerate(self.members)}
        at = np.array([place.get(element, 0) for element, _ in outputs], np.intp)
        nothing = np.zeros(3)
        share = [
            self.members[place[element]].forces.get(quantity, nothing) if element in place else nothing
            for element, quantity in outputs
        ]
        return at, np.array(share).reshape(len(outputs), 3)
