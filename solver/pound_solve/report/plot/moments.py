"""The instant at which a picture shows the structure: a time, or the force peak of a contact."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import courses
from pound_solve.report.plot.members import chosen_contacts
from pound_solve.report.plot.schema import Choice, ChoiceError
from pound_solve.results import Results

LARGEST: Final = "largest"  #: word for the contact with the largest force
PEAK_MISSED: Final = 1e-3  #: fraction of a peak by which the force at an instant must be lower to say so


class Moment(NamedTuple):
    """A history at one instant: the time [T], its row, and words for a title."""

    t: float
    row: Array
    title: str


def moment(results: Results, name: str, choice: Choice) -> Moment:
    """Find the instant of a history, close-ups included, that is nearest to the chosen time or force peak.

    Raises
    ------
    ChoiceError
        The history does not reach so far, or there is no such contact or force peak.
    """
    if name not in results.histories or not len(results.time):
        raise ChoiceError(f"the file has no history {name}, so no instant of it")
    t, rows = results.course(name)
    if choice.at_peak is None:
        at = choice.instant(results, t)
        return Moment(float(t[at]), rows[at], f"at {t[at]:.6g} {results.units.time}")
    contact, peak = force_peak(results, choice.at_peak)
    at = int(np.argmin(np.abs(t - peak["t_peak"])))
    return Moment(float(t[at]), rows[at], _title(results, contact, peak, float(t[at])))


def force_peak(results: Results, word: str) -> tuple[str, Any]:
    """Return the contact that a word names, and its collision with the largest peak force.

    Raises
    ------
    ChoiceError
        There is no such contact, or it had no collision with a force.
    """
    labels = results.labels("contact/force") if "contact/force" in results.histories else ()
    if word == LARGEST and LARGEST not in labels:
        names = labels
    else:
        names = tuple(labels[k] for k in chosen_contacts(results, Choice((word,))))
    peaks = [(name, row) for name in names if (row := courses.hardest(results, name)) is not None]
    if not peaks:
        who = f"contact {word}" if word != LARGEST else "the model"
        raise ChoiceError(f"{who} has no collision with a force: name a time with --time")
    return max(peaks, key=lambda peak: float(peak[1]["peak_force"]))


def _title(results: Results, contact: str, peak: Any, t: float) -> str:
    """Words for an instant at, or near, the force peak of a contact."""
    units = results.units
    reached = f"{peak['peak_force']:.6g} {units.force}"
    times, forces = results.course("contact/force")
    column = results.labels("contact/force").index(contact)
    force = float(forces[int(np.argmin(np.abs(times - t))), column])
    if force < (1.0 - PEAK_MISSED) * peak["peak_force"]:
        there = f"{peak['t_peak']:.6g} {units.time}"
        return (
            f"at {t:.6g} {units.time}, the stored instant nearest to the force peak of contact {contact}, "
            f"{reached} at {there}"
        )
    return f"at {t:.6g} {units.time}, the force peak of contact {contact}: {reached}"
