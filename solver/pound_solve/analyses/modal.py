r"""MODAL: natural modes with participation, effective mass and damping ratio.

For a ground direction with influence vector r:

.. math:: \Gamma_n = \phi_n^T M r, \qquad m_n^* = \Gamma_n^2, \qquad
          \xi_n = \frac{\phi_n^T C\,\phi_n}{2\omega_n}

for mass-normalised shapes; the effective masses of all modes add up to the mass
that the direction can move.

References
----------
Chopra AK (2012), Dynamics of Structures, 4th edn, sections 13.1 and 13.2.
"""

from __future__ import annotations

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.numerics.modes import moving_mass
from pound_solve.structure.assembly import Structure

SPEC = Spec(
    "analysis",
    "MODAL",
    "natural modes",
    (
        Field(
            "MODES",
            Kind.INT,
            default=None,
            lo=1,
            doc="number of modes; left out: all, at most 12",
            positional=True,
        ),
        Field("SHAPES", Kind.WORD, default="YES", words=("YES", "NO"), doc="print the mode shapes"),
        Field(
            "AFTER",
            Kind.WORD,
            default="REST",
            words=("REST", "STATIC"),
            doc="stiffness of the laws: initial with open contacts, or tangent in the static state",
        ),
    ),
)


def rows(structure: Structure, wanted: int | None) -> list[tuple[float, ...]]:
    """Rows of the table ``modes``.

    Parameters
    ----------
    structure : Structure
    wanted : int or None
        Number of modes.
    """
    n, sought = structure.n_free, 12 if wanted is None else wanted
    modes = structure.vibration(sought)
    count = min(len(modes.omega), sought)
    out: list[tuple[float, ...]] = []
    total = moving_mass(
        structure.initial_stiffness[:n, :n], structure.mass[:n, :n], structure.ground[:, :n]
    )
    c = structure.initial_damping[:n, :n]
    for i in range(count):
        w, shape = float(modes.omega[i]), modes.shapes[:, i]
        damping = float(shape @ c @ shape) / (2 * w) if w > 0 else float("nan")
        row = [i + 1, w, w / (2 * np.pi), 2 * np.pi / w if w > 0 else float("inf"), 100 * damping]
        for d in range(2):
            gamma = float(shape @ structure.ground[d, :n])
            gamma = 0.0 if gamma**2 < 1e-20 * total[d] else gamma  # rounding of a mode that takes no part
            row += [gamma, gamma**2, 100 * gamma**2 / float(total[d]) if total[d] > 0 else 0.0]
        out.append(tuple(row))
    return out


def shape_rows(structure: Structure, count: int) -> list[tuple[float, ...]]:
    """Rows of the table ``mode_shapes``: every node, largest component 1."""
    shapes = structure.vibration(count).shapes
    nodes = list(structure.model.nodes)
    every = structure.dofs.matrix([(node, d) for node in nodes for d in range(3)])
    pad = len(structure.dofs.moved)
    out: list[tuple[float, ...]] = []
    for i in range(count):
        full = np.concatenate([shapes[:, i], np.zeros(pad)])
        scale = np.abs(shapes[:, i]).max()
        x = every @ full / scale
        x[np.abs(x) < 1e-12] = 0.0  # rounding
        out += [(i + 1, node, *three) for node, three in zip(nodes, x.reshape(-1, 3).tolist())]
    return out
