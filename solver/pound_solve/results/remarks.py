"""Remarks that several tables share."""

from __future__ import annotations

from typing import Final

from pound_solve.results.record import RunRecord

SIGNS: Final = (
    "End forces act on the member along its own axes; axial tension and contact compression are positive, "
    "and so is the moment of a hinge where the member sags."
)


def how_found(run: RunRecord) -> str:
    """Sentence on whether the method's peaks are exact."""
    returned = run.history.returned
    if returned.one_of_several:
        return "Peaks are those of one of several motions: see the checks."
    if returned.exact:
        return "Peaks are exact."
    if run.history.recorder.envelopes.searched:
        return "Peaks between the ends of the steps are included."
    return "Peaks are those of the steps, interpolated between them."


def how_sampled(run: RunRecord) -> str:
    """Sentence on the instants at which envelopes are taken, with a trailing blank."""
    history, time = run.history, run.model.units.time
    envelopes = history.recorder.envelopes
    if envelopes.searched:
        return "Peaks between all instants of the method are included. "
    if not envelopes.seen:
        return (
            f"Taken at the output times, every {history.every:.6g} {time}: peaks between them are missed, "
            "a smaller OUTPUT EVERY finds them. "
        )
    return (
        f"Taken at the ends of all steps, at most {envelopes.apart:.3g} {time} apart; peaks within a step "
        "are not included. "
    )
