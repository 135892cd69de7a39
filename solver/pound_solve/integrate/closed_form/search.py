r"""The search of EXACT for events and peaks: in coarse cells adapted to the motion, and in fine steps if
needed.

The event functions of all laws and their slopes are sampled in cells whose length follows from a bound on
their curvature,

.. math:: |\ddot y(t)| \le \sum_i |r_i|\,|\ddot q_i(0)|

for a functional :math:`y = \mathrm{Re} \sum r_i q_i`, modes that do not grow, and linear excitation.  Most
cells therefore cannot contain an event.  The others are sampled on a grid that resolves the fastest mode.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.integrate.closed_form.dense_output import DenseOutput
from pound_solve.integrate.closed_form.grid_samples import GridSamples
from pound_solve.integrate.events import grid
from pound_solve.integrate.events.functions import EventFunctions, RowFunctions
from pound_solve.integrate.tolerances import EVENT_TOLERANCE
from pound_solve.integrate.tracker import Peak
from pound_solve.numerics.types import Array, Flags

MAX_FINE_STEPS = 64  #: largest number of steps of the fine grid in one cell
#: fraction of an event function's scale that its curvature may contribute within a cell
CURVATURE_SHARE = 0.05
CERTAIN = 1e3  #: multiple of the tolerance of event functions above which a value is certainly an event


class Search:
    """Event functions and monitored functions of a run on its present branches.

    Parameters
    ----------
    events : EventFunctions
    monitored : RowFunctions
    peaks : sequence of Peak
        Of the monitored functions.
    """

    def __init__(self, events: EventFunctions, monitored: RowFunctions, peaks: Sequence[Peak]) -> None:
        self.events, self.monitored, self.peaks = events, monitored, peaks
        self.second_rates = events.by_rate or monitored.by_rate

    def coarse(self, dense: DenseOutput, bounds: Array, h: float, largest: Array) -> GridSamples:
        """Sample a window in coarse cells.

        Parameters
        ----------
        dense : DenseOutput
        bounds : ndarray, shape (2, n_rows, n_intervals)
            Bounds of the second derivatives of the rows and of their rates.
        h : float
            Step of the fine grid [T].
        largest : ndarray, shape (2, n_rows)
            Largest magnitudes of rows and rates so far.
        """
        return GridSamples.of_window(dense, self._cell_length(bounds, h, largest), self.second_rates)

    def fine(self, coarse: GridSamples, bounds: Array, h: float, largest: Array) -> GridSamples:
        """Sample the cells that may contain an event or a peak at steps of `h`; parameters as for
        `coarse`.
        """
        if coarse.h <= h:
            return coarse
        return coarse.refined(self._cells(coarse, bounds, largest), h, self.second_rates)

    def _cell_length(self, bounds: Array, h: float, largest: Array) -> float:
        """Return the length of the coarse cells: a multiple of `h` over which the curvature has little
        effect.
        """
        if self.events.keys:
            curvature, scale = self.events.curvature_bounds(bounds), self.events.scale(largest)
        else:  # relative to their range so far
            curvature = self.monitored.curvature_bounds(bounds)
            scale = np.array([max(x.high - x.low, 0.0) for x in self.peaks])
        most = curvature.max(axis=1, initial=0.0)
        chosen = (scale > 0.0) & (most > 0.0)
        if not np.isfinite(most).all():
            return h
        if not chosen.any():
            return h * MAX_FINE_STEPS
        cell = float(np.sqrt(8.0 * CURVATURE_SHARE * (scale[chosen] / most[chosen]).min()))
        # powers of four: few lengths, so that tables can be reused
        steps = 4.0 ** np.floor(np.log2(max(cell / h, 1.0)) / 2.0)
        return h * float(min(steps, MAX_FINE_STEPS))

    def _cells(self, coarse: GridSamples, bounds: Array, largest: Array) -> Flags:
        """Return which cells may contain an event or a peak, shape (n_segments, count)."""
        cells = np.zeros((len(coarse.span), coarse.t.shape[1] - 1), bool)
        last = cells.size
        if self.events.keys:
            g, slope = self.events.sampled(coarse)
            scale = np.maximum(self.events.scale(largest), np.abs(g).max(axis=(1, 2)))
            least = CERTAIN * EVENT_TOLERANCE * scale[:, None, None]
            g[:, 0, 0] = np.minimum(g[:, 0, 0], 0.0)
            curvature = self.events.curvature_bounds(bounds)
            cells |= grid.may_rise(g, slope, curvature, coarse.widths).any(axis=0)
            sure = ((g[..., 1:] > least) & (g[..., :-1] <= 0.0)).any(axis=0).ravel()
            if sure.any():
                last = int(sure.argmax())
        if self.peaks:
            value, slope = self.monitored.sampled(coarse)
            curvature = self.monitored.curvature_bounds(bounds)
            cells |= grid.may_peak(value, slope, curvature, coarse.widths, self.peaks).any(axis=0)
        cells.ravel()[last + 1 :] = False  # the run does not reach these cells
        return cells

    def update_peaks(self, coarse: GridSamples, fine: GridSamples, t0: float, end: float) -> None:
        """Include the monitored functions in their peaks up to the local time `end` of a window from `t0`
        on, where the fine samples end.
        """
        if not self.peaks:
            return
        seen = coarse.t <= end
        grid.update_by_samples(self.peaks, t0 + coarse.t[seen], self.monitored.sampled(coarse)[0][:, seen])
        if fine.t.size:
            evaluate = self.monitored.evaluator(fine)
            grid.update_by_extremes(self.peaks, t0, fine.t, *self.monitored.sampled(fine), evaluate)
