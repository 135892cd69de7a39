r"""STATIC: displacements under the loads, event to event.

The laws are piecewise linear, so the path from the unloaded to the loaded structure is a chain
of straight pieces: at each one the load is raised until the next spring yields or the next contact closes,
exactly, and the stiffness is changed.  An initial overlap of a contact grows with the load too,
so that the start is stress-free.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pound_deck.schema import Field, Kind, Spec
from pound_solve.assemble import Structure
from pound_solve.dofs import label
from pound_solve.laws import State
from pound_solve.modes import deficiency, scaling

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StaticState:
    """Result of a static analysis.

    Attributes
    ----------
    u : ndarray, shape (n_free,)
        Displacements [L] or [rad].
    states : tuple
        State of every law.
    events : int
        Branch changes on the way.
    """

    u: Array
    states: tuple[State, ...]
    events: int


def at_rest(structure: Structure) -> StaticState:
    """The unloaded state: no displacement, every law virgin."""
    return StaticState(np.zeros(structure.n_free), tuple(s.law.start() for s in structure.laws), 0)


class Unstable(Exception):
    """The structure cannot carry the load: a mechanism, named by its worst freedom;
    `code` is the message's number.
    """

    def __init__(self, why: str, code: str = "A501") -> None:
        super().__init__(why)
        self.code = code


def solve(structure: Structure, most_events: int = 10_000) -> StaticState:
    """Load the structure from rest.

    Raises
    ------
    Unstable
        A loaded part is a mechanism, from the start or after yielding.
    """
    n = structure.n_free
    laws, rows = structure.laws, structure.law_rows[:, :n]
    load = structure.loads[:n]
    # the overlap of a contact is led in with the load: f = k (d - share * gap)
    overlaps = np.array([min(s.facts["gap"], 0.0) if s.is_contact else 0.0 for s in laws])
    if not load.any() and not overlaps.any():
        return at_rest(structure)
    states: list[State] = [s.law.start() for s in laws]
    d, u = np.zeros(len(laws)), np.zeros(n)
    share, events = 0.0, 0
    while share < 1.0:
        branches = [s.law.branch(x) for s, x in zip(laws, states)]
        k = structure.stiffness[:n, :n] + (rows.T * [b.stiffness for b in branches]) @ rows
        push = load + rows.T @ np.array([b.stiffness * o for b, o in zip(branches, overlaps)])
        step = _solve(structure, k, push)
        rate = rows @ step
        best, which = 1.0 - share, None
        for i, branch in enumerate(branches):
            # exits move with the overlap that is led in: along a contact the effective deformation
            # is d - (share-1) gap
            effective, speed = d[i] - (share - 1.0) * overlaps[i], rate[i] - overlaps[i]
            for e, (a, b, c) in enumerate(branch.exits):
                if a == 0.0:  # leaves where the motion turns
                    if b * rate[i] > 0 and best > 0.0:
                        best, which = 0.0, (i, e)
                    continue
                now, slope = a * effective + c, a * speed
                if slope > 1e-14 * (abs(a) * abs(speed) + 1e-300) and now + slope * best > 0:
                    at = max(-now / slope, 0.0)
                    if at < best:
                        best, which = at, (i, e)
        u, d, share = u + best * step, d + best * rate, share + best
        if which is None:
            break
        i, e = which
        states[i] = laws[i].law.leave(states[i], e, d[i] - (share - 1.0) * overlaps[i])
        events += 1
        if events > most_events:
            raise Unstable(
                f"more than {most_events} springs and contacts changed state under the static load", "A507"
            )
    return StaticState(u, tuple(states), events)


def _solve(structure: Structure, k: Array, load: Array) -> Array:
    """Solve K u = load; freedoms without stiffness stay at zero if nothing loads them."""
    n = len(k)
    held = np.any(k != 0.0, axis=1)
    loose = ~held & (load != 0.0)
    if loose.any():
        first = int(np.flatnonzero(loose)[0])
        touched = any(
            s.is_contact and row[first] != 0.0 for s, row in zip(structure.laws, structure.law_rows)
        )
        hint = ": only an open contact could; HISTORY FROM=REST lets it come down" if touched else ""
        raise Unstable(f"{_name(structure, first)} is loaded, but nothing holds it{hint}")
    at = np.flatnonzero(held)
    u = np.zeros(n)
    if not len(at):
        return u
    root = scaling(k[np.ix_(at, at)])
    scaled, push = root[:, None] * k[np.ix_(at, at)] * root, root * load[at]
    lacking = deficiency(scaled)
    if not lacking:
        u[at] = root * np.linalg.solve(scaled, push)
        return u
    values, vectors = np.linalg.eigh(scaled)
    weak = np.arange(len(at)) < lacking
    along = vectors.T @ push
    if np.any(values < -1e-10):
        worst = at[int(np.argmax(np.abs(vectors[:, 0])))]
        raise Unstable(
            "the stiffness is negative: the structure has collapsed, "
            f"worst at {_name(structure, int(worst))}"
        )
    if np.any(np.abs(along[weak]) > 1e-10 * np.abs(along).max()):
        worst = at[int(np.argmax(np.abs(vectors[:, weak] @ along[weak])))]
        raise Unstable(
            f"the loaded structure is a mechanism, worst at {_name(structure, int(worst))} (or parts of it "
            "are so much stiffer than others that it cannot be told from one: END1, END2 or SLAVED make "
            "parts rigid)"
        )
    # an unloaded mechanism (a free diaphragm) stays where it is
    along[weak] = 0.0
    u[at] = root * (vectors @ (along / np.where(weak, 1.0, values)))
    return u


def _name(structure: Structure, index: int) -> str:
    return label(structure.freedoms.free[index])


SPEC = Spec(
    "analysis",
    "STATIC",
    "displacements under the static loads",
    (
        Field(
            "GRAVITY",
            Kind.WORD,
            default="NO",
            words=("NO", "YES"),
            doc="let the nodal WEIGHTS load the structure downwards",
        ),
        Field(
            "SELF_WEIGHT",
            Kind.WORD,
            default="YES",
            words=("YES", "NO"),
            doc="let the weight WGT of the members load it",
        ),
    ),
)
