r"""MODAL: a damping ratio for every mode, constant matrix.

.. math:: C = M \Bigl(\sum_n 2\xi_n\omega_n\,\phi_n\phi_n^T\Bigr) M, \qquad \phi_n^T M \phi_n = 1

with the modes of the initial structure, contacts open.  Modes beyond the list take its last ratio.

References
----------
Wilson EL, Penzien J (1972), Evaluation of orthogonal damping matrices,
Int. J. Numer. Methods Engng 4: 5-10.
"""

from __future__ import annotations

import numpy as np

from pound_deck.model import Card
from pound_deck.schema import Field, Kind, Spec
from pound_solve.damping.base import Ground, Group


def build(card: Card, ground: Ground) -> Group:
    """Damping of the whole structure."""
    omega, shapes, mass = ground.modes()
    given = card["XI"]
    xi = np.array([given[min(n, len(given) - 1)] for n in range(len(omega))])
    weighted = mass @ shapes
    c = (weighted * (2 * xi * omega)) @ weighted.T
    text = ", ".join(f"{x:.6g}" for x in given)
    return Group(
        ground.pad(c),
        None,
        f"XI {text}" + (" (the last for all higher modes)" if len(given) < len(omega) else ""),
    )


SPEC = Spec(
    "damping",
    "MODAL",
    "ratio for each mode, constant matrix",
    (
        Field(
            "XI",
            Kind.REAL,
            "-",
            count=(1, 1000),
            lo=0,
            doc="damping ratio of mode 1, 2, ...; the last holds for the rest",
        ),
    ),
    code=4,
    reference="Wilson & Penzien 1972",
    impl=build,
)
