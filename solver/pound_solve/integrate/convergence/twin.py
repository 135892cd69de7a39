"""The twin of a run: a run of the same method, whose excitation differs in the eleventh digit.

EXACT and TAYLOR have only rounding errors, and most motions do not magnify them.  With repeated collisions
or hinges that nearly reverse, the motion may magnify them until no digit of a peak is correct, while the
energy balance and every other check remain good.  The excitation of the twin is larger by the fraction
`EXCITATION_CHANGE`, at least ten times the rounding error of a run.  The differences between the peaks of
the two runs therefore show the possible effect of rounding.  The twin keeps no histories and no envelopes.

A twin does not reveal ambiguities that both runs resolve in the same way, such as which of two springs of
equal strength yields; `uniqueness` finds these.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pound_solve.check import Check, Subject, at_most, beyond
from pound_solve.integrate.closed_form import exact
from pound_solve.integrate.convergence.compared import figures
from pound_solve.integrate.convergence.replay import Watch, Witness
from pound_solve.integrate.protocol import (
    INTERRUPTED,
    EnvelopeRecorder,
    Outcome,
    Problem,
    Recorder,
    Stop,
    reason_not_linear,
)

EXCITATION_CHANGE = 1e-11  #: relative change of the excitation
ABOUT = f"change of the peaks where the excitation changes by {EXCITATION_CHANGE:g}"
MAGNIFIED = "the motion magnifies rounding beyond TOL: these peaks are chance, so compare several motions"


def changed(problem: Problem[EnvelopeRecorder], witness: Witness) -> Problem[Recorder]:
    """Return the problem of the twin: inputs and velocities are larger by `EXCITATION_CHANGE` or, if there
    are neither, the displacements are.
    """
    system, start, factor = problem.system, problem.start, 1.0 + EXCITATION_CHANGE
    excitation = replace(system.excitation, coefs=factor * system.excitation.coefs)
    if excitation.coefs.any() or start.v.any():
        start = replace(start, v=factor * start.v)
    else:
        start = replace(start, u=factor * start.u)
    return Problem(replace(system, excitation=excitation, decisions=[]), start, problem.monitored, witness)


def again(problem: Problem[Recorder], method: str) -> Outcome:
    """Run EXACT or TAYLOR."""
    if method == "EXACT":
        return exact.integrate(problem, {})
    from pound_solve.integrate.series import taylor  # where it is not needed it is not loaded

    return taylor.integrate(problem, {})


def checks(problem: Problem[EnvelopeRecorder], run: Outcome, watch: Watch, tol: float) -> list[Check]:
    """Repeat a `run` that has only rounding errors, and return a check of how much it magnifies them.

    A run without events and with linear forces is not repeated, because it cannot magnify them.

    Parameters
    ----------
    watch : Watch
        The recorder of the run.
    tol : float
        Allowed change of the peaks, relative to their scales (see `compared`).

    Raises
    ------
    Stop
        There was an interrupt; the exception contains the outcome of the completed run.
    """
    system = problem.system
    if run.figures["events"] == 0 and not reason_not_linear(system):
        return []
    witness = Witness(watch.recorder)
    method = next(entry.decision for entry in reversed(system.decisions) if entry.subject == "method")
    try:
        twin = again(changed(problem, witness), method)
    except Stop as stop:
        if stop.code == "A506":
            raise Stop("A506", float(problem.start.times[-1]), INTERRUPTED, run) from None
        remark = f"it stops then: {stop.code} at t = {stop.t:.6g}; {MAGNIFIED}"
        return [beyond(Subject.MAGNIFICATION, ABOUT, np.inf, tol, remark)]
    first, second = figures(system, run.peaks, watch), figures(system, twin.peaks, witness)
    apart = np.abs(first.values - second.values) / np.where(first.scales > 0.0, first.scales, 1.0)
    return [at_most(Subject.MAGNIFICATION, ABOUT, apart.max(initial=0.0), tol, MAGNIFIED)]
