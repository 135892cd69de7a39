"""Stored motion for the envelopes (see `course`): the series of each step, and the initial state of each
interval in modes.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.law_state import Laws, LawTangent
from pound_solve.integrate.series.forces import total_force
from pound_solve.integrate.series.state import EnvelopeBuffers, Extent, Modal, Series
from pound_solve.numerics.types import Index

MAX_HELD = 2**21  #: most numbers stored for the steps and for the intervals
MAX_KEPT, MIN_KEPT = 4096, 8  #: most and fewest steps or intervals
STEPS, INTERVALS = range(2)  #: places in `EnvelopeBuffers.kept`


def allocate(unknowns: Index, laws: Index, modal: Modal, n_coefs: int) -> EnvelopeBuffers:
    """Allocate room for steps, whose series have `n_coefs` coefficients, and for intervals in modes; the
    `unknowns` and the forces of the `laws` are kept.
    """
    b, _, size = modal.x.shape
    steps = MAX_HELD // max(n_coefs * (len(unknowns) + len(laws)), 1)
    intervals = MAX_HELD // max(3 * modal.x.shape[1] * len(unknowns), 2 * b * size, 1)
    s, i = (int(np.clip(x, MIN_KEPT, MAX_KEPT)) for x in (steps, intervals))
    return EnvelopeBuffers(
        is_needed=len(unknowns) + len(laws) > 0,
        unknowns=unknowns,
        laws=laws,
        kept=np.zeros(2, np.int64),
        coefs=np.zeros((s, len(unknowns) + len(laws), n_coefs)),
        degree=np.zeros(s, np.int64),
        begin=np.zeros(s),
        length=np.zeros(s),
        x=np.zeros((i, b, size)),
        equilibrium=np.zeros((i, b, modal.equilibrium.shape[1])),
        constant_forces=np.zeros((i, len(laws))),
        start=np.zeros(i),
    )


def is_full(envelope: EnvelopeBuffers) -> bool:
    """Return whether there is no room for another step."""
    return bool(envelope.kept[STEPS] == len(envelope.begin))


def keep_step(laws: Laws, series: Series, extent: Extent) -> None:
    """Store the series of a step.  Call this while the laws are still as at its start."""
    t, h, degree, end = extent
    envelope = series.envelope
    if not envelope.is_needed:
        return
    at, n = envelope.kept[STEPS], len(envelope.unknowns)
    for i in range(n):
        coefs, unknown = envelope.coefs[at, i], envelope.unknowns[i]
        for k in range(degree + 1):
            coefs[k] = series.motion[k, unknown]
    for i in range(len(envelope.laws)):
        total_force(laws, series, degree, h, envelope.laws[i], envelope.coefs[at, n + i])
    for i in range(envelope.coefs.shape[1]):
        for k in range(degree + 1, envelope.coefs.shape[2]):
            envelope.coefs[at, i, k] = 0.0
    if end < 1.0:
        power = 1.0
        for k in range(1, degree + 1):
            power *= end
            for i in range(envelope.coefs.shape[1]):
                envelope.coefs[at, i, k] *= power
    envelope.degree[at], envelope.begin[at], envelope.length[at] = degree, t, h * end
    envelope.kept[STEPS] += 1


def has_room(envelope: EnvelopeBuffers) -> bool:
    """Return whether another interval in modes can be stored."""
    return bool(envelope.kept[INTERVALS] < len(envelope.start))


def keep_interval(tangent: LawTangent, series: Series, t: float) -> None:
    """Store the modes at the start of an interval, the time `t`."""
    envelope, modal = series.envelope, series.modal
    if not envelope.is_needed:
        return
    at = envelope.kept[INTERVALS]
    for b in range(len(modal.counts)):
        for i in range(modal.x.shape[2]):
            envelope.x[at, b, i] = modal.x[b, 0, i]
        for i in range(modal.equilibrium.shape[1]):
            envelope.equilibrium[at, b, i] = modal.equilibrium[b, i]
    for i in range(len(envelope.laws)):
        law = envelope.laws[i]
        envelope.constant_forces[at, i] = tangent.stiffness[law] * modal.offset[law] + tangent.offset[law]
    envelope.start[at] = t
    envelope.kept[INTERVALS] += 1
