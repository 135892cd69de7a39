r"""Idealisation of a capacity curve by an elastic, perfectly plastic line, and the N2 method.

The curve, measured from the static state, is followed up to a displacement :math:`d_m`.  The line has the
largest base shear :math:`V_y` up to there, and its yield displacement makes the areas below line and curve
equal (EN 1998-1:2004, B.3):

.. math:: d_y = 2\left(d_m - \frac{E_m}{V_y}\right), \qquad E_m = \int_0^{d_m} V\,\mathrm{d}d

The building is taken to fail where :math:`0.8\,V_y` is left (Park 1988), or at the end of the curve; this
ultimate displacement over :math:`d_y` is its ductility.

The equivalent oscillator has the mass :math:`m^*`, the force :math:`V/\Gamma` and the displacement
:math:`d/\Gamma` (see `load_pattern.EquivalentSystem`), hence the period

.. math:: T^* = 2\pi\sqrt{m^* d_y / V_y} .

The N2 method (EN 1998-1:2004, B.5; Fajfar 2000) finds its displacement from the elastic spectrum
:math:`S_e`.  With :math:`d_{et} = S_e(T^*)\,(T^*/2\pi)^2` and :math:`q_u = S_e(T^*)\,\Gamma m^*/V_y`

.. math:: d_t = \Gamma\,d_{et} \times \begin{cases} 1 & T^* \ge T_C \text{ or } q_u \le 1 \\
          \bigl(1 + (q_u - 1)\,T_C/T^*\bigr)/q_u & \text{otherwise} \end{cases}

The line depends on :math:`d_m`, which the standard lets the user adjust until :math:`d_t = d_m`.  Here
:math:`d_m` is that solution, the first on a grid of displacements: the result depends neither on the target
nor on the stations of the curve.

References
----------
EN 1998-1:2004, Eurocode 8: Design of structures for earthquake resistance, Part 1, annex B.
Fajfar P (2000), A nonlinear analysis method for performance based seismic design, Earthquake Spectra
16(3): 573-592.
Park R (1988), State of the art report: ductility evaluation from laboratory and analytical testing, Proc.
9th World Conf. Earthquake Engng VIII: 605-616.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import takewhile
from typing import Final, TypeAlias

import numpy as np

from pound_solve.analyses.load_pattern import EquivalentSystem
from pound_solve.analyses.pushover import CapacityPoint, PushoverResult
from pound_solve.loading.motions.base import GroundMotion
from pound_solve.loading.piecewise import Piecewise
from pound_solve.loading.spectrum import pseudo_acceleration
from pound_solve.numerics.types import Array

#: elastic pseudo-acceleration [L/T^2] at each of some periods [T], shape (n,)
Demand: TypeAlias = Callable[[Array], Array]
PRECISION: Final = 1e-12  #: error of the performance point, as a fraction of itself
ROUNDING: Final = 1e-9  #: fraction of a displacement or shear below which a difference is rounding error
#: shortest period, as a multiple of the longest interval of a motion: it is divided into 16 parts
SHORTEST: Final = 1.0 / 8.0
#: ratio of the displacements between which the performance point is sought: periods differ by 2 % at most
RATIO: Final = 2.0 ** (1.0 / 16.0)
STARTS: Final = 160  #: number of such ratios below the end of a curve that bends from its start
LEFT: Final = 0.8  #: share of the largest base shear that is left at the ultimate displacement


@dataclass(frozen=True)
class CapacityLine:
    """Elastic, perfectly plastic line from the static state.

    Attributes
    ----------
    end : float
        Displacement up to which the curve was followed [L].
    yield_displacement, yield_shear : float
        [L], [F]
    """

    end: float
    yield_displacement: float
    yield_shear: float

    @property
    def stiffness(self) -> float:
        """Slope of the elastic part [F/L]."""
        return self.yield_shear / self.yield_displacement

    def period(self, system: EquivalentSystem) -> float:
        """Return the period of the equivalent oscillator [T]."""
        return 2.0 * math.pi * math.sqrt(system.mass / self.stiffness)


@dataclass(frozen=True)
class PerformancePoint:
    """Result of the N2 method for one spectrum.

    Attributes
    ----------
    line : CapacityLine
        Its end is the performance point.
    period : float
        Of the equivalent oscillator [T].
    acceleration : float
        Ordinate of the elastic spectrum there [L/T^2].
    reduction : float
        :math:`q_u`, acceleration of the elastic oscillator over that of the yielding one.
    demand : float
        Displacement of the control node from the static state that follows from this line [L].
    displacement : float
        Of the control node at the end of the line, including the static one [L].
    """

    line: CapacityLine
    period: float
    acceleration: float
    reduction: float
    demand: float
    displacement: float


class CapacityCurve:
    """Base shear over control displacement, both from the static state and in the sense of the push.

    Parameters
    ----------
    points : sequence of CapacityPoint
        Of one leg.
    """

    def __init__(self, points: Sequence[CapacityPoint]) -> None:
        self.start = first = points[0]
        self.sense = math.copysign(1.0, points[-1].displacement - first.displacement)
        self.d = self.sense * np.array([p.displacement - first.displacement for p in points])
        self.v = self.sense * np.array([p.shear - first.shear for p in points])
        steps = 0.5 * np.diff(self.d) * (self.v[1:] + self.v[:-1])
        self._energy = np.concatenate([[0.0], np.cumsum(steps)])
        self._largest = np.maximum.accumulate(self.v)
        self._goes_back = bool((np.diff(self.d) < -ROUNDING * np.abs(self.d).max()).any())

    def _grid(self) -> list[float]:
        """Return the displacements between which the performance point is sought: corners of the curve, its
        end, and powers of `RATIO` beyond the first corner, up to which the period is one and the same.
        With piecewise linear laws only the end depends on the target.  A curve that does not move has none.
        """
        d, v = self.d, self.v
        if not d[-1] > 0.0:
            return []
        before, after = (np.diff(x)[:-1] for x in (d, v)), (np.diff(x)[1:] for x in (d, v))
        (dx0, dy0), (dx1, dy1) = before, after
        bends = np.abs(dy1 * dx0 - dy0 * dx1) > ROUNDING * (np.abs(dy1 * dx0) + np.abs(dy0 * dx1))
        corners = d[1:-1][bends]
        first, last = float(corners[0] if len(corners) else d[-1]), float(d[-1])
        if first <= 0.0:  # it bends from the start
            first = last * RATIO**-STARTS
        powers = range(math.ceil(math.log(first, RATIO)), math.floor(math.log(last, RATIO)) + 1)
        return sorted(
            {x for x in (*corners.tolist(), last, *(RATIO**n for n in powers)) if 0.0 < x <= last}
        )

    @property
    def strongest(self) -> float:
        """Furthest displacement at which the base shear is the largest [L]."""
        return float(self.d[self.v >= (1.0 - ROUNDING) * self.v.max()].max())

    @property
    def ultimate(self) -> float:
        """Displacement where `LEFT` of the largest base shear is left, or the end of the curve [L]."""
        least = LEFT * float(self.v.max())
        fallen = (self.d >= self.strongest) & (self.v < least)
        if not fallen.any():
            return float(self.d[-1])
        k = int(np.argmax(fallen))
        (d0, d1), (v0, v1) = self.d[k - 1 : k + 1].tolist(), self.v[k - 1 : k + 1].tolist()
        return float(d0 + (d1 - d0) * (v0 - least) / (v0 - v1))

    def line(self, end: float) -> CapacityLine | None:
        """Return the line up to a displacement above zero.  None where the control node goes back, and
        where the curve stiffens as much as it does when a contact closes: no line has its area.
        """
        k = int(np.searchsorted(self.d, end, "right")) - 1
        shear = float(np.interp(end, self.d, self.v))
        largest = max(float(self._largest[k]), shear)
        if largest <= 0.0 or self._goes_back:
            return None
        energy = float(self._energy[k]) + 0.5 * (end - float(self.d[k])) * (float(self.v[k]) + shear)
        at_yield = 2.0 * (end - energy / largest)
        if not 0.0 < at_yield <= end * (1.0 + ROUNDING):
            return None
        return CapacityLine(end, min(at_yield, end), largest)

    def performance(
        self, system: EquivalentSystem, demand: Demand, corner: float
    ) -> PerformancePoint | None:
        """Return the performance point, the first on a grid of displacements that is dense in periods; None
        if the curve ends, or has no line, before it.

        Parameters
        ----------
        system : EquivalentSystem
        demand : callable
            Elastic spectrum.
        corner : float
            Period :math:`T_C` at which its constant acceleration ends [T].
        """
        from scipy.optimize import brentq  # slow to import, and few decks need it

        lines = list(takewhile(bool, map(self.line, self._grid())))
        points = self._points(lines, system, demand, corner)
        after = next((n for n, p in enumerate(points) if p.demand <= p.line.end), None)
        if after is None:
            return None

        def at(end: float) -> PerformancePoint | None:
            return next(iter(self._points([self.line(end)], system, demand, corner)), None)

        def excess(end: float) -> float:
            return point.demand - end if (point := at(end)) else end  # without a line: not reached

        high = points[after].line.end
        low = points[after - 1].line.end if after else PRECISION * high
        if excess(low) <= 0.0:  # a ground at rest
            return at(low)
        return at(brentq(excess, low, high, xtol=PRECISION * high))

    def _points(
        self, lines: Sequence[CapacityLine | None], system: EquivalentSystem, demand: Demand, corner: float
    ) -> list[PerformancePoint]:
        """Return the answer of the N2 method for each line."""
        sound = [line for line in lines if line is not None]
        if not sound:
            return []
        periods = [line.period(system) for line in sound]
        points = list[PerformancePoint]()
        for line, period, acceleration in zip(sound, periods, demand(np.array(periods)).tolist()):
            elastic = system.factor * acceleration * (period / (2.0 * math.pi)) ** 2
            reduction = acceleration * system.factor * system.mass / line.yield_shear
            inelastic = elastic
            if period < corner and reduction > 1.0:
                inelastic *= (1.0 + (reduction - 1.0) * corner / period) / reduction
            displacement = self.start.displacement + self.sense * line.end
            points.append(PerformancePoint(line, period, acceleration, reduction, inelastic, displacement))
        return points


def demands(
    pushed: PushoverResult, motions: Iterable[GroundMotion]
) -> Iterator[tuple[EquivalentSystem, str, Demand]]:
    """Yield the equivalent oscillator of a pushover with TC, with the number, the name and the spectrum of
    each motion along its direction.
    """
    card, system = pushed.card, pushed.equivalent
    for n, motion in enumerate(motions, 1):
        if system and card["TC"] is not None and motion.direction == card["DIRECTION"]:
            yield system, f"{n} {motion.name}", partial(_ordinates, motion.acceleration, card["XI"])


def performance_points(
    pushed: PushoverResult, motions: Iterable[GroundMotion]
) -> list[tuple[str, PerformancePoint | None]]:
    """Return the performance point of a pushover with TC for each motion along its direction, with the name
    of the motion.
    """
    curve, corner = CapacityCurve(pushed.curve), pushed.card["TC"]
    return [
        (name, curve.performance(system, spectrum, corner))
        for system, name, spectrum in demands(pushed, motions)
    ]


def _ordinates(acceleration: Piecewise, damping: float, periods: Array) -> Array:
    """Return pseudo-accelerations [L/T^2], shape (n,).  Oscillators stiffer than any building get that of
    `SHORTEST`, which is hardly more than the peak of the ground.
    """
    periods = np.maximum(periods, SHORTEST * float(np.diff(acceleration.breaks).max()))
    return np.asarray(pseudo_acceleration(acceleration, periods, damping)[0])
