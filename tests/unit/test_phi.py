"""phi: integrals of the exponential against powers, against sixty-digit arithmetic."""

from __future__ import annotations

from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pound_solve.numerics import phi

MOST = 11  #: highest degree that a record of degree 10 asks of `duhamel` (its integral)
Pair = tuple[Decimal, Decimal]


def times(a: Pair, b: Pair) -> Pair:
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def over(a: Pair, b: Pair) -> Pair:
    size = b[0] * b[0] + b[1] * b[1]
    top = times(a, (b[0], -b[1]))
    return top[0] / size, top[1] / size


def exponential(z: Pair) -> Pair:
    """e^z: Taylor series of z / 2^m, squared m times."""
    halvings = max(0, int(np.ceil(np.log2(float(abs(z[0]) + abs(z[1])) + 1e-300))) + 2)
    small = z[0] / 2**halvings, z[1] / 2**halvings
    term: Pair = (Decimal(1), Decimal(0))
    total = term
    for n in range(1, 60):
        term = times(term, small)
        term = term[0] / n, term[1] / n
        total = total[0] + term[0], total[1] + term[1]
    for _ in range(halvings):
        total = times(total, total)
    return total


def reference(z: complex, degree: int) -> tuple[list[complex], list[complex]]:
    """K_0 .. K_degree and J_0 .. J_degree at `z` by the definitions, good to 17 digits."""
    with localcontext() as context:
        context.prec = 70
        d = Decimal(z.real), Decimal(z.imag)
        k_all, j_all = [], []
        if abs(z) < 1.0:
            for k in range(degree + 1):
                # K_k = k! sum z^n / (n+k+1)!  and  J_k = sum z^n / (n! (n+k+1))
                power, k_term = (Decimal(1), Decimal(0)), Decimal(1) / (k + 1)
                inverse = Decimal(1)
                k_sum = j_sum = (Decimal(0), Decimal(0))
                for n in range(60):
                    k_sum = k_sum[0] + power[0] * k_term, k_sum[1] + power[1] * k_term
                    j_term = inverse / (n + k + 1)
                    j_sum = j_sum[0] + power[0] * j_term, j_sum[1] + power[1] * j_term
                    power, k_term, inverse = times(power, d), k_term / (n + k + 2), inverse / (n + 1)
                k_all.append(k_sum)
                j_all.append(j_sum)
        else:
            # the recurrences lose 12 digits at the very most, 58 are left
            e = exponential(d)
            last_k = last_j = over((e[0] - 1, e[1]), d)
            k_all.append(last_k)
            j_all.append(last_j)
            for k in range(1, degree + 1):
                last_k = over((k * last_k[0] - 1, k * last_k[1]), d)
                last_j = over((e[0] - k * last_j[0], e[1] - k * last_j[1]), d)
                k_all.append(last_k)
                j_all.append(last_j)
        return [complex(*map(float, x)) for x in k_all], [complex(*map(float, x)) for x in j_all]


def worst(z: np.ndarray, degree: int) -> tuple[float, float]:
    """Largest relative errors of K (with and without a given e^z) and of J.

    Near the imaginary axis the integrals of whole waves vanish (z = 2 pi i n): there the measure is the
    natural size 1 / (1 + |z|); everywhere else it is the value itself.
    """
    expected = [reference(complex(x), degree) for x in z]
    k_ref = np.array([e[0] for e in expected]).T
    j_ref = np.array([e[1] for e in expected]).T
    floor = np.where(np.abs(z.real) < 1.0, 0.5 / (1.0 + np.abs(z)), 0.0)
    k_size, j_size = np.maximum(np.abs(k_ref), floor), np.maximum(np.abs(j_ref), floor)
    both = (phi.duhamel(z, degree), phi.duhamel(z, degree, np.exp(z)))
    of_k = max(float((np.abs(k - k_ref) / k_size).max()) for k in both)
    return of_k, float((np.abs(phi.moments(z, degree) - j_ref) / j_size).max())


def left_half_plane(radii: np.ndarray) -> np.ndarray:
    angles = np.pi * np.array([0.5, 0.5001, 0.55, 0.65, 0.8, 0.95, 1.0, -0.5, -0.7])
    return np.asarray((radii[:, None] * np.exp(1j * angles)).ravel())


RADII = np.concatenate(
    [10.0 ** np.arange(-12, -1), np.geomspace(0.05, 60.0, 45), 10.0 ** np.arange(2, 4.1, 0.5)]
)


@pytest.mark.full
@pytest.mark.parametrize("degree", [0, 1, 2, 3, 4, 6, 8, MOST])
def test_left_half_plane(degree: int) -> None:
    # measured: K 2e-15 up to degree 8 and 3e-14 at 11, J 4e-15 up to 3, 3e-14 up to 8, 8e-13 at 11 (seam)
    of_k, of_j = worst(left_half_plane(RADII), degree)
    assert of_k < (5e-15 if degree < 9 else 1e-13)
    assert of_j < (8e-15 if degree < 4 else 6e-14 if degree < 9 else 2e-12)


@pytest.mark.full
@pytest.mark.parametrize("degree", [1, 3, MOST])
def test_right_half_plane(degree: int) -> None:
    """Negative stiffness grows: the same functions at positive real parts."""
    radii = RADII[RADII < 100.0]
    of_k, of_j = worst(-left_half_plane(radii), degree)
    assert of_k < (1e-14 if degree < 4 else 1e-12)
    assert of_j < (1e-14 if degree < 4 else 1e-13)


@pytest.mark.parametrize("degree", [0, 1, 2, 3, 4, MOST])
def test_seam_between_series_and_recurrence(degree: int) -> None:
    radius = phi._near(degree)[0]
    z = left_half_plane(radius * np.array([1.0 - 1e-15, 1.0 - 1e-9, 1.0 + 1e-9, 1.0 + 1e-15]))
    of_k, of_j = worst(z, degree)
    assert of_k < 1e-13
    assert of_j < 2e-12


def test_zero() -> None:
    for of in (phi.duhamel, phi.moments):
        assert np.allclose(of(np.zeros(2, complex), 4)[:, 0], 1.0 / np.arange(1, 6), rtol=1e-16, atol=0.0)


def test_shape_follows_the_argument() -> None:
    z = left_half_plane(np.array([1e-3, 2.0, 30.0])).reshape(3, 9)
    assert phi.duhamel(z, 2).shape == phi.moments(z, 2).shape == (3, 3, 9)
    assert np.array_equal(phi.duhamel(z, 2).reshape(3, -1), phi.duhamel(z.ravel(), 2))


@given(st.floats(1e-9, 30.0), st.floats(0.5, 1.5), st.integers(0, MOST))
def test_time_runs_backwards(size: float, angle: float, degree: int) -> None:
    """Read from its other end the integral is K_k(z) = e^z J_k(-z): it joins the two across the plane."""
    z = np.array([size * np.exp(1j * np.pi * angle)])
    k, j = phi.duhamel(z, degree), np.exp(z) * phi.moments(-z, degree)
    assert np.allclose(k, j, rtol=1e-12, atol=1e-15)


def test_the_reference_itself() -> None:
    """Gauss quadrature of the definitions, to the rounding of its sums."""
    x, w = np.polynomial.legendre.leggauss(60)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    for z in (-0.7 + 0.2j, -3.0 + 8.0j, 12.0j, -25.0 + 0.0j):
        k, j = reference(z, MOST)
        for n in range(MOST + 1):
            assert abs(w @ (np.exp(z * (1 - x)) * x**n) - k[n]) < 1e-13
            assert abs(w @ (np.exp(z * x) * x**n) - j[n]) < 1e-13
