"""Static loads press contacts that touch: curved laws have no stiffness where they touch."""

from __future__ import annotations

import numpy as np
import pytest

from decks import solved, structure_of
from pound_solve.analyses import static
from pound_solve.assess.law_test import specimen
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import BranchKind, drive
from samples import has_loop
from verification.cases import run_text

LAWS = {
    name: f"LAW={name} {specimen(spec)[1]}"
    for name, spec in catalog().family("contact").items()
    if has_loop(spec)
}


def row(law: str, load: float, held: str = "", gap: float = 0.0) -> str:
    """Three bodies and a wall that touch, the first perhaps but for a gap; it is pushed to the others."""
    return f"""
NODES
 1 TO 3 0 TO 2 0 FIX=YR
 4 3 0 FIX=XYR
ELEMENTS
 1 FIRST 1 2
 2 REST 2 3
 3 REST 3 4
{held}
PROPS
 FIRST CONTACT {law.replace("GAP=0", f"GAP={gap!r}")}
 REST CONTACT {law}
 S SPRING KX=1
WEIGHTS
 1 TO 3 100
LOADS
 1 {load!r}
"""


@pytest.mark.parametrize("load", [1e-6, 3.0])
@pytest.mark.parametrize("name", LAWS)
def test_every_contact_of_a_row_carries_the_load(name: str, load: float) -> None:
    text = row(LAWS[name], load)
    s = solved(text)
    assert [s.force[i, "contact"] for i in (1, 2, 3)] == pytest.approx([load] * 3, rel=1e-11)
    law = s.structure.laws[0].law
    if not law.rigid:  # each is as deep as the law says for that force
        overlap = s.u[3][0]
        assert law.force(drive(law, law.start(), 0.0, overlap), overlap)[0] == pytest.approx(
            load, rel=1e-11
        )
        assert [s.u[i][0] for i in (1, 2)] == pytest.approx([3 * overlap, 2 * overlap], rel=1e-11)


@pytest.mark.parametrize("n", [1.2, 1.5, 2.65, 6.0])
def test_the_overlap_is_the_root_of_the_force(n: float) -> None:
    s = solved(row(f"GAP=0 LAW=HERTZ K=1E7 N={n!r}", 300.0))
    assert s.u[3][0] == pytest.approx((300.0 / 1e7) ** (1.0 / n), rel=1e-12)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_a_body_on_a_spring_meets_the_row_on_its_way(name: str, gap: float) -> None:
    """The spring takes over what the contacts do not."""
    s = solved(row(LAWS[name], 3.0, " 9 S 1", gap))
    forces = [s.force[i, "contact"] for i in (1, 2, 3)]
    assert forces == pytest.approx([3.0 - s.u[1][0]] * 3, rel=1e-9)
    assert 0.0 < forces[0] < 3.0


@pytest.mark.parametrize("seed", range(8))
def test_a_row_of_masses_between_walls_is_in_its_one_equilibrium(seed: int) -> None:
    """Elastic contacts have a convex energy, so that any point without force out of balance is the one."""
    rng = np.random.default_rng(seed)
    n = 5
    ground, load = rng.uniform(10.0, 100.0, n), rng.normal(size=n) * 5.0
    ground[[1, 3]] = (
        0.0  # bodies that only contacts hold, and of which some are not pressed from both sides
    )
    load[[1, 3]] = 0.0
    gaps = rng.uniform(0.0, 0.05, n + 1) * (rng.random(n + 1) < 0.4)
    lines = [f"NODES\n 1 TO {n} 1 TO {n} 0 FIX=YR\nELEMENTS"]
    lines += [f" {i + 1} S{i + 1} {i + 1}" for i in range(n) if ground[i]]
    lines += [f" {n + i} C{i} {i} {i + 1}" for i in range(1, n)]
    lines += [f" {2 * n} C{n} {n}", f" {2 * n + 1} C0 1", "PROPS"]
    lines += [f" S{i + 1} SPRING KX={k!r}" for i, k in enumerate(ground.tolist()) if k]
    lines += [f" C{i} CONTACT GAP={g!r} LAW=HERTZ K=1E4" for i, g in enumerate(gaps.tolist()) if i]
    lines += [f" C0 CONTACT GAP={gaps.tolist()[0]!r} ANGLE=180 LAW=HERTZ K=1E4"]
    lines += ["LOADS", *(f" {i + 1} {p!r} 0" for i, p in enumerate(load.tolist()))]
    u = static.solve(structure_of("\n".join(lines))).u
    rows = np.array(
        [-np.eye(n)[0], *(np.eye(n)[i] - np.eye(n)[i + 1] for i in range(n - 1)), np.eye(n)[-1]]
    )
    contacts = 1e4 * np.maximum(rows @ u - gaps, 0.0) ** 1.5
    assert contacts.max() > 0.1
    assert ground * u + rows.T @ contacts == pytest.approx(load, abs=1e-9)


def test_a_pull_opens_what_touches() -> None:
    s = solved(row("GAP=0 LAW=HERTZ K=1E7", -300.0, " 9 S 1"))
    assert s.u[1][0] == pytest.approx(-300.0, rel=1e-12)
    assert all(
        x.law.branch(state).kind is BranchKind.OPEN
        for x, state in zip(s.structure.laws, s.state.states)
        if x.role.collides
    )


def test_a_history_starts_from_the_pressed_state() -> None:
    """Nothing excites it: the contacts keep their forces."""
    text = row("GAP=0 LAW=HERTZDAMP K=1E7 E=0.5", 300.0, " 9 S 1")
    r = run_text(text + "ANALYSIS\n STATIC\n HISTORY 0.5\n")
    assert r.status == "done", r.message
    assert r.force == pytest.approx(np.repeat(300.0 - r.u[:, :1, 0], 3, axis=1), rel=1e-9)


@pytest.mark.parametrize("load", [0.0, -7.0])
@pytest.mark.parametrize("name", LAWS)
def test_a_girder_that_lies_on_its_bearings(name: str, load: float) -> None:
    """On the first contact alone it would turn, and close the other; each carries half of its weight."""
    law = LAWS[name].replace("GAP=0.01", "GAP=0")
    s = solved(f"""
NODES
 1 0 0 FIX=X
 2 2 0 FIX=X
 3 6 0 FIX=X
 4 TO 5 0 TO 6 -1 FIX=XYR
ELEMENTS
 1 TO 2 GIRDER 1 TO 2 2 TO 3
 3 BEARING 1 4
 4 BEARING 3 5
PROPS
 GIRDER FRAME E=34E6 A=0.75 I=0.14 WGT=24
 BEARING CONTACT {law} ANGLE=270
WEIGHTS
 2 1
LOADS
 2 0 {load}
""")
    forces = [s.force[i, "contact"] for i in (3, 4)]
    assert forces == pytest.approx([72.0 - load * 2 / 3, 72.0 - load / 3], rel=1e-8)
