"""The quantities of a run as functions of readings at instants that the run knows."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

from pound_solve.analyses.history import HistoryResult
from pound_solve.integrate.tracker import Extreme
from pound_solve.laws.automaton import GAP
from pound_solve.results.words import contact_name
from pound_solve.sensitivity.coefficients import Coefficients
from pound_solve.sensitivity.dual import Dual
from pound_solve.sensitivity.measured import Places
from pound_solve.sensitivity.samples import ObservedKind, ObservedValue
from pound_solve.structure.storeys import storeys


class PeakFormula(NamedTuple):
    """A quantity.

    Attributes
    ----------
    quantity, label : str
        As in `sweep.study.quantities`.
    readings : tuple of ObservedValue
    value : callable
        Returns it from the readings as dual numbers.
    """

    quantity: str
    label: str
    readings: tuple[ObservedValue, ...]
    value: Callable[..., Dual]


class PeakFormulas:
    """The quantities of one history.

    Parameters
    ----------
    history : HistoryResult
    base, slopes : Coefficients
        Numbers of the history, and their derivatives.
    places : Places
        Of the measured rows.
    """

    def __init__(
        self, history: HistoryResult, base: Coefficients, slopes: Coefficients, places: Places
    ) -> None:
        self.history, self.base, self.slopes, self.places = history, base, slopes, places
        self.model = history.system.structure.model

    def all(self) -> Iterator[PeakFormula]:
        """Yield all quantities."""
        yield from self._periods()
        yield from self._drifts()
        yield from self._contacts()
        yield from self._ends()
        yield from self._bases()
        yield from self._storeys()
        yield from self._springs()

    def _constant(self, name: str, *index: int) -> Dual:
        """Return one of the coefficients as a dual number."""
        return Dual(getattr(self.base, name)[index], getattr(self.slopes, name)[(slice(None), *index)])

    def _periods(self) -> Iterator[PeakFormula]:
        if len(self.base.periods):
            period = self._constant("periods", 0)
            yield PeakFormula("period", "", (), lambda: period)

    def _drifts(self) -> Iterator[PeakFormula]:
        peaks = self.history.returned.peaks.monitored
        for i, ((name, ratio), peak) in enumerate(zip(self.history.drift_ratios(), peaks)):
            reading = _largest(ObservedKind.ROW, self.places.drifts + i, peak)
            yield PeakFormula("peak_drift", name, (reading,), abs)
            if ratio == ratio:
                height = self._constant("heights", i)
                yield PeakFormula("drift_ratio", name, (reading,), lambda y, h=height: abs(y) / h)

    def _contacts(self) -> Iterator[PeakFormula]:
        peaks, structure = self.history.returned.peaks, self.history.system.structure
        for law in self.history.items.contacts:
            name = contact_name(self.model, structure.laws[law].element)
            gap, nothing = (
                self._constant("parameters", law, GAP),
                0.0 * self._constant("parameters", law, GAP),
            )
            collisions = [c for c in peaks.collisions if c.law == law]
            count = nothing + float(len(collisions))
            yield PeakFormula("closures", name, (), lambda n=count: n)
            yield PeakFormula("given_gap", name, (), lambda g=gap: g)
            if collisions:
                best = max(collisions, key=lambda c: c.peak)
                force = ObservedValue(ObservedKind.FORCE, law, best.t_peak, best.peak)
                yield PeakFormula("contact_force", name, (force,), lambda f: f)
            else:
                yield PeakFormula("contact_force", name, (), lambda n=nothing: n)
            total = sum(c.impulse for c in collisions)
            impulse = ObservedValue(ObservedKind.IMPULSE, law, math.nan, total)
            yield PeakFormula("impulse", name, (impulse,), lambda p: p)
            peak = peaks.deformation[law]
            closest = ObservedValue(ObservedKind.DEFORMATION, law, peak.t_high, peak.high)
            yield PeakFormula("min_gap", name, (closest,), lambda d, g=gap: g - d)
            yield PeakFormula(
                "penetration", name, (closest,), lambda d, g=gap, n=nothing: d - g if d > g else n
            )
            if not peaks.collisions:
                yield PeakFormula("needed_gap", name, (closest,), lambda d, n=nothing: d if d > 0.0 else n)

    def _ends(self) -> Iterator[PeakFormula]:
        items, structure = self.history.items, self.history.system.structure
        envelope = self.history.recorder.envelopes.node["u"]
        for (law, end), row in self.places.ends.items():
            spring = structure.laws[law]
            element = self.model.elements[spring.element]
            node = (element.i, element.j)[end]
            along = spring.facts["angle"]
            if along % 90.0 or node not in items.nodes:
                continue  # its peak is that of samples
            assert node is not None
            at = 3 * items.nodes.index(node) + (1 if along % 180.0 else 0)
            high, t_high, low, t_low = envelope.rows()[at]
            reading = _largest(ObservedKind.ROW, row, Extreme(high, t_high, low, t_low))
            yield PeakFormula(
                ("peak_i", "peak_j")[end], contact_name(self.model, spring.element), (reading,), abs
            )

    def _bases(self) -> Iterator[PeakFormula]:
        largest = self.history.recorder.envelopes.sums["base"].largest()
        for n, b in enumerate(self.history.items.buildings):
            for quantity, component in (("base_shear", 0), ("overturning_moment", 2)):
                value, t = largest[3 * n + component]
                if value:
                    row = self.places.sums["base"] + 3 * n + component
                    yield PeakFormula(
                        quantity, b.name, (ObservedValue(ObservedKind.ROW, row, t, value),), abs
                    )

    def _storeys(self) -> Iterator[PeakFormula]:
        sums, history = self.history.recorder.envelopes.sums, self.history
        drift, force, motion = (sums[name].largest() for name in ("drift", "storey", "acceleration"))
        end = float(history.recorder.reached)
        for n, (b, i) in enumerate(storeys(history.items.buildings)):
            label, first = f"{b.name} {i}", self.places.sums
            peaks = [("storey_shear", first["storey"] + 2 * n, force[2 * n])]
            peaks.append(("floor_acceleration", first["acceleration"] + n, motion[n]))
            if i not in b.bearings:
                peaks.append(("storey_drift", first["drift"] + n, drift[n]))
                left = ObservedValue(ObservedKind.ROW, first["drift"] + n, end, math.nan, is_peak=False)
                yield PeakFormula("residual_drift", label, (left,), lambda y: y)
            for quantity, row, (value, t) in peaks:
                yield PeakFormula(quantity, label, (ObservedValue(ObservedKind.ROW, row, t, value),), abs)

    def _springs(self) -> Iterator[PeakFormula]:
        laws = {id(s): i for i, s in enumerate(self.history.system.structure.laws)}
        for r in self.history.springs:
            if r.ductility != r.ductility:
                continue
            law = laws[id(r.spring)]
            sides = []
            for side, d, t, f, tf in (
                (0, r.deformation.high, r.deformation.t_high, r.force.high, r.force.t_high),
                (1, r.deformation.low, r.deformation.t_low, r.force.low, r.force.t_low),
            ):
                limit = (r.spring.yields or (0.0, 0.0))[side]
                if abs(limit) > 0.0:
                    sides.append((r.spring.whole(d, f) / limit, side, (d, t), (f, tf)))
            _, side, (d, t), (f, tf) = max(sides)
            readings = (
                ObservedValue(ObservedKind.DEFORMATION, law, t, d),
                ObservedValue(ObservedKind.STATIC_FORCE, law, tf, f),
            )
            at_yield, beside = self._constant("yields", law, side), self._constant("beside", law)
            yield PeakFormula(
                "ductility",
                f"{r.spring.element} {r.spring.component}",
                readings,
                lambda d, f, y=at_yield, g=beside: (d + g * f) / y,
            )


def _largest(kind: ObservedKind, index: int, peak: Extreme) -> ObservedValue:
    """Return the reading of the larger side of an extreme."""
    if peak.high >= -peak.low:
        return ObservedValue(kind, index, peak.t_high, peak.high)
    return ObservedValue(kind, index, peak.t_low, peak.low)
