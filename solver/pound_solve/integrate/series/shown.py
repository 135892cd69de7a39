"""Kernels of TAYLOR: what they keep of the motion for the envelopes, see `course`.

The forces of the laws over a step are kept at Chebyshev's nodes (`numerics.crests.NODES`): the force of a
law need be no series.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.laws import law_force
from pound_solve.integrate.kernels.state import Laws
from pound_solve.integrate.series.expansion import TERMS, law_at
from pound_solve.integrate.series.forces import press
from pound_solve.integrate.series.state import Modal, Series, Shown
from pound_solve.laws.functions import Tables
from pound_solve.numerics.crests import NODES
from pound_solve.numerics.types import Index

MOST_HELD = 2**21  #: numbers of the steps and of the intervals that are kept, at most
MOST_STEPS, FEWEST = 4096, 8  #: of these
STEPS, INTERVALS = range(2)  #: places in `Shown.kept`


def allocate(which: Index, acting: Index, modal: Modal) -> Shown:
    """Room for steps and intervals, of which the unknowns `which` and the laws `acting` are seen."""
    b, _, size = modal.x.shape
    steps = MOST_HELD // max((TERMS + 1) * len(which) + len(NODES) * len(acting), 1)
    intervals = MOST_HELD // max(3 * modal.x.shape[1] * len(which), 2 * b * size, 1)
    s, i = (int(np.clip(x, FEWEST, MOST_STEPS)) for x in (steps, intervals))
    return Shown(
        is_needed=np.array([len(which) + len(acting) > 0]),
        which=which,
        acting=acting,
        nodes=NODES,
        kept=np.zeros(2, np.int64),
        coefs=np.zeros((s, TERMS + 1, len(which))),
        law_forces=np.zeros((s, len(NODES), len(acting))),
        begin=np.zeros(s),
        length=np.zeros(s),
        end=np.zeros(s),
        x=np.zeros((i, b, size)),
        rest=np.zeros((i, b, modal.rest.shape[1])),
        held=np.zeros((i, len(acting))),
        start=np.zeros(i),
    )


def is_full(shown: Shown) -> bool:
    """Whether no step has room."""
    return bool(shown.kept[STEPS] == len(shown.begin))


def keep_step(
    laws: Laws, rules: Tables, series: Series, terms: int, h: float, end: float, t: float
) -> None:
    """Keep the series of a step from time `t` to its place `end`, while the laws are as at its start."""
    shown = series.shown
    if not shown.is_needed[0]:
        return
    at = shown.kept[STEPS]
    coefs, forces = shown.coefs[at], shown.law_forces[at]
    for k in range(TERMS + 1):
        for i in range(len(shown.which)):
            coefs[k, i] = series.motion[k, shown.which[i]] if k <= terms else 0.0
    if len(shown.acting):
        for node in range(len(shown.nodes)):
            s = shown.nodes[node] * end
            press(laws, series, terms, s, h)
            for i in range(len(shown.acting)):
                law = shown.acting[i]
                d, v = law_at(series, terms, s, h, law)
                forces[node, i] = law_force(laws, rules, law, d, v)
    shown.begin[at], shown.length[at], shown.end[at] = t, h, end
    shown.kept[STEPS] += 1


def has_room(shown: Shown) -> bool:
    """Whether another interval in modes can be kept."""
    return bool(shown.kept[INTERVALS] < len(shown.start))


def keep_interval(laws: Laws, series: Series, t: float) -> None:
    """Keep the modes at the start of an interval, the time `t`."""
    shown, modal = series.shown, series.modal
    if not shown.is_needed[0]:
        return
    at = shown.kept[INTERVALS]
    for b in range(len(modal.counts)):
        for i in range(modal.x.shape[2]):
            shown.x[at, b, i] = modal.x[b, 0, i]
        for i in range(modal.rest.shape[1]):
            shown.rest[at, b, i] = modal.rest[b, i]
    for i in range(len(shown.acting)):
        law = shown.acting[i]
        shown.held[at, i] = laws.stiffness[law] * modal.offset[law] + laws.offset[law]
    shown.start[at] = t
    shown.kept[INTERVALS] += 1
