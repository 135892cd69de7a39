"""Motions of a deck's EQUAKE cards as record files, for other decks, studies and programs."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from pound_solve.driver.prepare import ground
from pound_solve.driver.request import Request
from pound_solve.loading.motions.base import GroundMotion
from pound_solve.loading.records import peer
from pound_solve.user_error import UserError

EQUAL: Final = 1e-9  #: relative difference of equal steps, because times are sums
MAX_STEPS: Final = 10**7  #: most steps of a file


class MotionError(UserError):
    """Raised if a motion cannot be written to a file; the message states why."""


@dataclass(frozen=True)
class MotionFile:
    """One file.

    Attributes
    ----------
    name : str
        With its ending.
    text : str
    warning : str
        Properties of the motion that the file lacks; empty without any.
    """

    name: str
    text: str
    warning: str = ""


def of_deck(request: Request, dt: float | None = None) -> Iterator[MotionFile]:
    """Yield a record file for every translation under EQUAKE, in shares of the deck's gravity.

    Parameters
    ----------
    request : Request
    dt : float or None
        Step of the samples [T]; None for that of the motion.

    Raises
    ------
    DeckError
        The deck or a record has mistakes.
    MotionError
        There is no motion, or one has no step and `dt` is not given.
    OSError
        The deck cannot be read.
    """
    deck = ground(request)
    translations = [m for m in deck.motions if m.direction != "R"]
    if not translations:
        raise MotionError(f"{request.deck} has no motion along X or Y under EQUAKE")
    for number, motion in enumerate(translations, 1):
        yield _file(number, motion, deck.model.gravity, dt)


def _file(number: int, motion: GroundMotion, gravity: float, dt: float | None) -> MotionFile:
    """Make the record file of one motion."""
    name, a = str(motion.info["name"]), motion.acceleration
    steps = np.diff(a.breaks)
    equal = len(a.coefs) <= 2 and bool(np.ptp(steps) <= EQUAL * steps.mean())
    if dt is None and not equal:
        raise MotionError(f"{name} has no step of its own: give the step of its samples with --dt")
    step = float(steps.mean()) if dt is None else dt
    if dt is None:
        step = float(f"{step:.12g}")  # of times that are sums
    steps_of_file = (a.end - a.start) / step
    if not 1.0 - EQUAL <= steps_of_file <= MAX_STEPS:
        message = f"--dt {step:g} divides {name} into {steps_of_file:.3g} steps"
        raise MotionError(f"{message}, and a file holds from one to {MAX_STEPS:g}")
    count = int(np.ceil(steps_of_file - EQUAL)) + 1
    times = np.minimum(a.start + step * np.arange(count), a.end)
    values = np.asarray(a.value(times)) / gravity
    lost = "" if equal and dt is None else "between its samples the file holds straight lines"
    stem = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_").lower()
    return MotionFile(f"{number:02d}_{stem}.at2", peer.written(name, values, step), lost)
