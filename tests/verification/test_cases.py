"""Every row of every verification case within its tolerance, and the manual's page fresh."""

from __future__ import annotations

import math
import re

import pytest

from tiers import at_night
from verification import cases

pytestmark = pytest.mark.full


LONG = ("bar_on_wall", "two_bars", "unit_impact")  # a tenth of a minute and more each


@pytest.mark.parametrize("name", [*(name for name in cases.CASES if name not in LONG), *at_night(*LONG)])
def test_rows(name: str) -> None:
    rows = cases.CASES[name].rows()
    assert rows
    wrong = [
        f"{r.quantity}: {r.computed:.15g} is not {r.expected:.15g} within {r.tol:g} (off by {r.error:.2e})"
        for r in rows
        if not r.ok
    ]
    assert not wrong, "\n".join(wrong)


@pytest.mark.slow  # it computes all rows again
def test_page_is_fresh() -> None:
    committed = cases.PAGE.read_text(encoding="utf-8")
    assert committed == cases.page(committed), "run: python tests/verification/cases.py"


def test_page_and_examples_name_each_other() -> None:
    committed = cases.PAGE.read_text(encoding="utf-8")
    decks = {p.relative_to(cases.DECKS).as_posix() for p in cases.DECKS.rglob("*.inp")}
    assert decks == {d for c in cases.CASES.values() for d in c.decks}
    for deck in re.findall(r"\(\.\./examples/verification/([^)]+)\)", committed):
        assert deck in decks
    for folder in {d.split("/")[0] for d in decks}:
        assert (cases.DECKS / folder / "README.md").is_file(), folder


@pytest.mark.parametrize(("n", "finer"), [cases.MESHES[:2], *at_night(cases.MESHES[1:])])
@pytest.mark.parametrize(
    ("name", "bars"),
    [cases.BAR_SETS[0], *at_night(*cases.BAR_SETS[1:])],
    ids=[n for n, _ in cases.BAR_SETS],
)
def test_bars_come_nearer_with_the_mesh(name: str, bars: cases.Bars, n: int, finer: int) -> None:
    error, smaller = (abs(cases.e_eff(bars, mesh) - bars.restitution()) for mesh in (n, finer))
    assert smaller < error


@pytest.mark.parametrize("n", [cases.MESHES[0], *at_night(*cases.MESHES[1:])])
def test_raw_peak_overshoots_on_every_mesh(n: int) -> None:
    """A lumped chain's first peak stands 44.5 % (equal bars) and 13.7 % (Table IV) above the plateau,
    whatever n."""
    for bars, over in ((cases.EQUAL, 1.44529), (cases.TABLE_IV, 1.13718)):
        peak = float(cases.collide(bars, n).column("collisions", "peak_force").max()) / bars.force
        assert peak == pytest.approx(over, abs=1e-5)


def test_stairs_by_momentum() -> None:
    """The closed form by another way: the free end of each bar from wave reflections, counted on a fine
    magic-step grid.

    With equal transit times per cell, d'Alembert's solution on a grid is exact: velocities and forces
    move one cell a step.
    """
    for bars in (cases.STAIRS, cases.HALF, cases.EQUAL):
        (z1, z2), (t1, t2) = bars.z, bars.period
        cells = [round(t / 2 * 1000) for t in (t1, t2)]
        # characteristics v + f/z (towards the contact) and v - f/z (from it); compression positive, bar 1
        # moves at v
        towards1, from1 = [bars.v] * cells[0], [bars.v] * cells[0]
        towards2, from2 = [0.0] * cells[1], [0.0] * cells[1]
        impulse, dt = 0.0, 1e-3
        for _ in range(round(1.2 * t2 / dt)):
            a, b = towards1[-1], towards2[-1]
            f = max(0.0, (a - b) / (1 / z1 + 1 / z2))
            impulse += f * dt
            towards1, from1 = [from1[-1], *towards1[:-1]], [a - 2 * f / z1, *from1[:-1]]
            towards2, from2 = [from2[-1], *towards2[:-1]], [b + 2 * f / z2, *from2[:-1]]
        reduced = bars.m1 * bars.m2 / (bars.m1 + bars.m2)
        assert math.isclose(impulse / (reduced * bars.v) - 1.0, bars.restitution(), abs_tol=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "bars"), cases.BAR_SETS, ids=[n for n, _ in cases.BAR_SETS])
def test_bars_of_400_elements(name: str, bars: cases.Bars) -> None:
    error = abs(cases.e_eff(bars, 400) - bars.restitution())
    assert error < cases.ripple(400)
    assert error < abs(cases.e_eff(bars, 200) - bars.restitution())
