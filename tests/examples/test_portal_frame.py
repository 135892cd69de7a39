"""Example 02 against slope deflection, hand-made matrices and scipy's ``lsim``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.signal import lsim

FOLDER = Path(__file__).parents[2] / "examples" / "02_portal_frame"
STATIC, EARTHQUAKE = FOLDER / "static.inp", FOLDER / "earthquake.inp"

# the decks' numbers, written down a second time
SPAN, H, E, Q, P, G = 8.0, 4.0, 30e6, 30.0, 100.0, 9.81
AC, IC, AB, IB = 0.16, 0.4**4 / 12, 0.18, 0.3 * 0.6**3 / 12


def slope_deflection() -> tuple[np.ndarray, np.ndarray]:
    """Sway and rotations of the joints, and reactions of both bases (x, y, moment), no axial deformation.

    M_ij = (2 E I / L) (2 theta_i + theta_j - 3 psi) + fixed-end moment, anticlockwise on the member's ends;
    a sway to the right turns a column clockwise, psi = -sway / H.
    """
    column, beam, fixed = 2 * E * IC / H, 2 * E * IB / SPAN, Q * SPAN**2 / 12
    # unknowns theta2, theta3, sway: moments at joints 2 and 3, and the columns' shear against P
    a = np.array(
        [
            [2 * column + 2 * beam, beam, 3 * column / H],
            [beam, 2 * column + 2 * beam, 3 * column / H],
            [3 * column / H, 3 * column / H, 12 * column / H**2],
        ]
    )
    t2, t3, sway = np.linalg.solve(a, [-fixed, fixed, P])
    base = [column * (t + 3 * sway / H) for t in (t2, t3)]
    head = [column * (2 * t + 3 * sway / H) for t in (t2, t3)]
    end2, end3 = beam * (2 * t2 + t3) + fixed, beam * (t2 + 2 * t3) - fixed
    up = Q * SPAN / 2 + (end2 + end3) / SPAN
    reactions = [[-(b + h) / H, y, b] for b, h, y in zip(base, head, (up, Q * SPAN - up), strict=True)]
    return np.array([sway, t2, t3]), np.array(reactions)


def test_the_formulas_of_the_readme_are_slope_deflection():
    (sway, *_), reactions = slope_deflection()
    k = IB / IC * H / SPAN
    m_q, m_p = Q * SPAN**2 / (12 * (k + 2)), P * H / 2 * (3 * k + 1) / (6 * k + 1)
    couple = 3 * P * H * k / (SPAN * (6 * k + 1))
    assert k == pytest.approx(1.265625)
    assert sway == pytest.approx(P * H**3 / (12 * E * IC) * (3 * k + 2) / (6 * k + 1), rel=1e-12)
    left = [3 * m_q / H - P / 2, Q * SPAN / 2 - couple, m_p - m_q]
    right = [-3 * m_q / H - P / 2, Q * SPAN / 2 + couple, m_p + m_q]
    np.testing.assert_allclose(reactions, [left, right], rtol=1e-12)


def test_static_is_slope_deflection_where_members_are_rigid_axially(run):
    (sway, t2, t3), reactions = slope_deflection()
    errors = {}
    for area in ("1E2", "1E3", "1E6"):
        _, results, _ = run(STATIC, {"ac": area, "ab": area})
        got = results.table("reactions")
        u = {row["node"]: row for row in results.table("static_displacement")}
        mine = np.r_[u[2]["x"], u[3]["x"], u[2]["r"], u[3]["r"], got["fx"], got["fy"], got["mz"]]
        want = np.r_[sway, sway, t2, t3, reactions.T.ravel()]
        errors[area] = np.abs(mine / want - 1).max()
    assert errors["1E6"] < 1e-6
    # what is left is the axial flexibility, until rounding takes over
    assert errors["1E2"] / errors["1E3"] == pytest.approx(10, rel=0.01)


def member(ea: float, ei: float, start: tuple[float, float], end: tuple[float, float]) -> np.ndarray:
    """Global stiffness of a beam-column, shape (6, 6), from its flexibility as a cantilever."""
    (x, y), length = np.subtract(end, start), np.hypot(*np.subtract(end, start))
    c, s = x / length, y / length
    # tip of a cantilever fixed at its start: displacement along, across and rotation from unit forces there
    tip = np.array(
        [
            [length / ea, 0, 0],
            [0, length**3 / (3 * ei), length**2 / (2 * ei)],
            [0, length**2 / (2 * ei), length / ei],
        ]
    )
    k = np.linalg.inv(tip)
    rigid = np.array([[1, 0, 0], [0, 1, length], [0, 0, 1]])  # what a motion of the start does at the end
    turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    relative = np.hstack([-rigid @ turn, turn])
    return relative.T @ k @ relative


def frame() -> tuple[np.ndarray, np.ndarray]:
    """Mass and stiffness of ux, uy of joints 2 and 3, rotations condensed."""
    at = {1: (0.0, 0.0), 2: (0.0, H), 3: (SPAN, H), 4: (SPAN, 0.0)}
    place = {2: [0, 1, 4], 3: [2, 3, 5]}
    k = np.zeros((6, 6))
    for i, j, ea, ei in ((1, 2, E * AC, E * IC), (4, 3, E * AC, E * IC), (2, 3, E * AB, E * IB)):
        whole = member(ea, ei, at[i], at[j])
        ends = [(n, row) for row, n in enumerate((i, j)) if n in place]
        for m, r in ends:
            for n, q in ends:
                k[np.ix_(place[m], place[n])] += whole[3 * r : 3 * r + 3, 3 * q : 3 * q + 3]
    condensed = k[:4, :4] - k[:4, 4:] @ np.linalg.solve(k[4:, 4:], k[4:, :4])
    return np.eye(4) * Q * SPAN / 2 / G, condensed


def test_modes(run):
    m, k = frame()
    values, shapes = eigh(k, m)
    omega = np.sqrt(values)
    r = np.array([1.0, 0.0, 1.0, 0.0])
    effective = (shapes.T @ m @ r) ** 2
    _, results, _ = run(EARTHQUAKE)
    table = results.table("modes")
    np.testing.assert_allclose(table["omega"], omega, rtol=1e-9)
    np.testing.assert_allclose(table["period"], 2 * np.pi / omega, rtol=1e-9)
    np.testing.assert_allclose(table["share_x"], 100 * effective / (r @ m @ r), rtol=1e-7, atol=1e-9)
    alpha, beta = rayleigh(omega)
    np.testing.assert_allclose(table["damping"], 100 * (alpha / omega + beta * omega) / 2, rtol=1e-9)


def rayleigh(omega: np.ndarray) -> tuple[float, float]:
    """Factors that give 5 % at the first two modes."""
    a = np.array([[1 / omega[0], omega[0]], [1 / omega[1], omega[1]]]) / 2
    alpha, beta = np.linalg.solve(a, [0.05, 0.05])
    return float(alpha), float(beta)


def test_history(run):
    _, results, _ = run(EARTHQUAKE)
    time, ground = results.time, results.history("ground")[:, 0]
    samples = (results.table("motions")["dt"][0], time[1] - time[0])
    assert samples[0] == pytest.approx(samples[1])  # every sample of the motion is stored
    m, k = frame()
    alpha, beta = rayleigh(np.sqrt(eigh(k, m, eigvals_only=True)))
    c = alpha * m + beta * k
    inverse = np.linalg.inv(m)
    a = np.block([[np.zeros((4, 4)), np.eye(4)], [-inverse @ k, -inverse @ c]])
    b = np.r_[np.zeros(4), -1, 0, -1, 0][:, None]
    pick = np.zeros((2, 8))
    pick[0, 0] = pick[1, 2] = 1
    _, dynamic, _ = lsim((a, b, pick, np.zeros((2, 1))), ground, time)
    drift = results.history("drift")
    np.testing.assert_allclose(drift[0], [-drift[0, 1], drift[0, 1]])  # the beam's load, symmetric
    size = np.abs(dynamic).max()
    assert size > 5e-3
    # after the last sample the motion is zero at once, which straight lines between samples do not show
    before = time < 10.0
    np.testing.assert_allclose((drift - drift[0])[before], dynamic[before], atol=1e-9 * size)
    assert np.abs(drift).max() == pytest.approx(size, rel=0.01)
