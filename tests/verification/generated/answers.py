"""Answers of methods to a deck, and how far they are apart."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping
from contextlib import nullcontext
from pathlib import Path
from typing import NamedTuple
from unittest import mock

import numpy as np

import pound_solve
from pound_solve.check import Subject
from pound_solve.driver.prepare import DeckError
from pound_solve.numerics.types import Array
from pound_solve.results import Results

STEPS = "STEPS"  #: AUTO that may take neither EXACT nor TAYLOR
#: share of the largest force of all contacts below which a contact's is not taken relative to itself
SMALL_FORCE = 0.05


class Answer(NamedTuple):
    """What a method says.

    Attributes
    ----------
    status, message : str
        As in the results file.
    method : str
        That was taken.
    seconds : float
        CPU time of the history [s].
    claimed : float or None
        Error that AUTO estimates; None where it takes no steps.
    magnified : float or None
        What AUTO says that rounding may do to the peaks; None where it takes steps.
    met : bool
        Whether it says that the tolerance is met.
    unique : bool
        Whether it finds only one motion.
    peaks : dict
        By kind: drift, contact, spring, hinge, displacement, acceleration, member; an array of rows.
    units : list of str
        Kinds of members' forces, in the order of their peaks.
    """

    status: str
    message: str
    method: str
    seconds: float
    claimed: float | None
    magnified: float | None
    met: bool
    unique: bool
    peaks: dict[str, Array]
    units: list[str]


def answer(deck: Path, records: Path | None, method: str, options: Mapping[str, float]) -> Answer:
    """Solve a deck by a method; STEPS is AUTO without EXACT and TAYLOR."""
    from pound_solve.integrate import auto

    steps = method == STEPS
    bars = {"reason_not_linear": lambda system: "barred", "has_series": lambda system: False}
    bar = mock.patch.multiple(auto, **bars) if steps else nullcontext()
    folders = [] if records is None else [records]
    chosen = "AUTO" if steps else method
    with tempfile.TemporaryDirectory() as out:
        try:
            with bar, pound_solve.run(deck, out=out, records=folders, method=chosen, **options) as results:
                return _read(results)
        except DeckError as err:
            return Answer("refused", str(err), "", 0.0, None, None, False, True, {}, [])


def _read(results: Results) -> Answer:
    """Read an answer from a results file."""
    facts = {r["item"]: r["value"] for name in ("run", "run_figures") if name in results.tables
             for r in results.table(name)}  # fmt: skip
    claimed, magnified, met, unique = None, None, True, True
    for check in results.checks:
        if check.subject is Subject.ERROR:
            claimed, met = check.value, not check.looks
        elif check.subject is Subject.MAGNIFICATION:
            magnified, met = check.value, not check.looks
        elif check.subject is Subject.UNIQUENESS:
            unique = not check.looks
    done = results.status == "done"
    return Answer(
        results.status,
        results.message,
        facts.get("method", "").split(",")[0],
        float(facts.get("solve seconds, CPU", "nan")),
        claimed,
        magnified,
        met,
        unique,
        _peaks(results) if done else {},
        [re.sub(r" [IJ]$", "", str(q)) for q in results.table("member_envelope")["quantity"]]
        if done
        else [],
    )


def _peaks(results: Results) -> dict[str, Array]:
    """Peaks of a run.  Those of nodes and members are at the output times, which all methods share."""
    found = {"drift": np.zeros((0, 2)), "spring": np.zeros((0, 2)), "hinge": np.zeros((0, 3))}
    for name, table, high, low in (
        ("drift", "drift_envelope", "max", "min"),
        ("spring", "spring_envelope", "deformation_max", "deformation_min"),
    ):
        if table in results.tables:
            rows = results.table(table)
            found[name] = np.column_stack([rows[high], rows[low]])
    if "spring_envelope" in results.tables:
        found["hinge"] = _hinges(results.table("spring_envelope"))
    found["contact"] = np.array(results.table("contact_summary")["peak_force"])[:, None]
    for name, history in (
        ("displacement", "node/u"),
        ("acceleration", "node/a"),
        ("member", "member/force"),
    ):
        values = results.history(history)
        values = values[..., :2] if name != "member" else values  # rotations are not looked at
        values = values.reshape(len(values), -1)
        found[name] = np.column_stack([values.max(axis=0), values.min(axis=0)])
    return found


def _hinges(rows: Array) -> Array:
    """Ductility, plastic work, and force times deformation at yield of each spring that can yield."""
    rows = rows[np.isfinite(rows["ductility"])]
    force, size = (
        np.maximum(np.abs(rows[f"{name}_max"]), np.abs(rows[f"{name}_min"]))
        for name in ("force", "deformation")
    )
    at_yield = size / np.maximum(rows["ductility"], 1e-300)
    return np.column_stack([rows["ductility"], rows["plastic_work"], force * at_yield])


def errors(own: Answer, truth: Answer) -> dict[str, float]:
    """Largest differences of the peaks of two answers by kind, relative to their scales.

    ``auto`` is what AUTO estimates: drifts relative to themselves, contact forces with a floor, ductilities
    and plastic work of hinges; without drifts springs and displacements, too.  ``contact of own`` and
    ``contact of largest`` relate a contact's force to its own peak and to the largest of all contacts;
    accelerations are those along x.
    """
    out = {}
    a, b = own.peaks, truth.peaks
    ductility, work, unit = b["hinge"].T
    off = np.abs(a["hinge"] - b["hinge"]).T
    shares = off[0] / np.maximum(ductility, 1.0), off[1] / np.maximum(work, unit)
    out["hinge"] = float(np.max(shares, initial=0.0))
    gap = {kind: np.abs(a[kind] - b[kind]) for kind in b}
    force = np.abs(b["contact"])
    largest = force.max(initial=0.0)
    out["drift"] = _worst(gap["drift"], np.abs(b["drift"]).max(axis=1, initial=0.0)[:, None])
    out["spring"] = _worst(gap["spring"], np.abs(b["spring"]).max(axis=1, initial=0.0)[:, None])
    out["contact of own"] = _worst(gap["contact"], force)
    out["contact of largest"] = _worst(gap["contact"], largest)
    out["contact"] = _worst(gap["contact"], np.maximum(force, SMALL_FORCE * largest))
    across = np.arange(len(b["displacement"])) % 2
    size = np.array([np.abs(b["displacement"][across == d]).max(initial=0.0) for d in (0, 1)])
    out["displacement"] = _worst(gap["displacement"], size[across][:, None])
    out["acceleration"] = _worst(gap["acceleration"][::2], np.abs(b["acceleration"][::2]).max(initial=0.0))
    units = np.array(truth.units)
    size = np.array([np.abs(b["member"][units == u]).max(initial=0.0) for u in truth.units])
    out["member"] = _worst(gap["member"], size[:, None])
    kinds = ("drift",) if len(b["drift"]) else ("spring", "displacement")
    out["auto"] = max(out[kind] for kind in (*kinds, "contact", "hinge"))
    return out


def _worst(gap: Array, scale: Array | float) -> float:
    """Largest difference relative to its scale; what is nothing in both answers does not count."""
    whole = np.broadcast_to(np.asarray(scale, float), gap.shape)
    some = gap > 1e-12 * whole.max(initial=0.0)
    return float((gap[some] / np.maximum(whole[some], 1e-300)).max(initial=0.0))
