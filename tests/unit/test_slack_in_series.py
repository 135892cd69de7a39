"""Hinges in series over a joint without mass: one becomes slack while the other comes to no force."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from decks import results_of
from kernels import FAST
from pound_solve.numerics.types import Array
from tiers import each_once

pytestmark = FAST

# the moments of column and beam at node 2 are equal: both hinges come to none at one instant
FRAME = """UNITS kN m s
NODES
  1 0 0 FIX=XYR
  2 0 4
  3 5 4 FIX=YR
ELEMENTS
  {column} COLUMN 1 2
  {beam} BEAM 2 3
PROPS
  COLUMN FRAME E=2.7E7 A=0.18 I=0.00135 LP=0.21 MI=200 MJ=60 RULE={rule}
  BEAM FRAME E=2.7E7 A=0.16 I=0.0018 LP=0.26 MI=70 MJ=70 RULE=BILINEAR_SLACK R=0.1 SLACK=0.001
WEIGHTS
  2 150 150 {turn}
  3 150
DAMPING
  RAYLEIGH ALPHA=0.3 BETA={beta}
EQUAKE
  SYNTHETIC PGA=5.0 SEED={seed} DURATION=5 RISE=1 STRONG=3 WG=15
OUTPUT
  EVERY=0.02
ANALYSIS
  HISTORY 5 METHOD={method}
"""
COLUMN_FIRST, BEAM_FIRST = (1, 2), (2, 1)


def motion(
    folder: Path, method: str, rule: str, numbers: tuple[int, int], turn: str, beta: str, seed: int
) -> Array:
    """Displacement of the joint."""
    deck = folder / "frame.inp"
    column, beam = numbers
    deck.write_text(
        FRAME.format(column=column, beam=beam, method=method, rule=rule, turn=turn, beta=beta, seed=seed)
    )
    with results_of(deck) as results:
        assert results.status == "done"
        moved: Array = results.history("node/u")[:, 1, 0]
    return moved


@each_once(
    ("rule", ["Q_HYST R=0.05 ALFA=0.4", "TAKEDA_SLIP R=0.05"]),
    ("numbers", [COLUMN_FIRST, BEAM_FIRST]),
    ("seed", [2, 4, 5]),
    at_most=2,
)
def test_all_methods_find_the_motion_of_a_joint_with_a_little_mass(
    tmp_path: Path, rule: str, numbers: tuple[int, int], seed: int
) -> None:
    """The column's hinge goes through no force, whatever the order of elements, as it does with dashpots
    that go to zero, and with a rotational weight that does.  Where rounding decided, they were 7 % apart.
    """
    own, none = (rule, numbers), ("0", "0", seed)
    series = motion(tmp_path, "TAYLOR", *own, *none)
    size = np.abs(series).max()
    assert motion(tmp_path, "EXACT", *own, *none) == pytest.approx(series, abs=1e-10 * size)
    assert motion(tmp_path, "LAGUERRE TOL=1e-9", *own, *none) == pytest.approx(series, abs=1e-7 * size)
    for steps in ("NEWMARK DT=5e-4", "HHT DT=5e-4 ALPHA=-0.05"):
        assert motion(tmp_path, steps, *own, *none) == pytest.approx(series, abs=1e-3 * size)
    light, damped = ("0", "3e-7", seed), ("1e-4", "1e-6", seed)
    implicit = "LAGUERRE TOL=1e-8"
    assert motion(tmp_path, implicit, *own, *light) == pytest.approx(series, abs=1e-4 * size)
    assert motion(tmp_path, implicit, *own, *damped) == pytest.approx(series, abs=5e-4 * size)
