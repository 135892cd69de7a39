"""Kernels of loads and of products with sparse matrices and rows."""

from __future__ import annotations

from pound_solve.integrate.kernels.sparse import Product, Rows
from pound_solve.integrate.kernels.state import LinearSystem
from pound_solve.numerics.types import Array


def evaluate_inputs(coefs: Array, s: float, inputs: Array, rates: Array) -> None:
    """Compute the inputs and their rates at the local time `s` of a piece of the excitation."""
    top, n = coefs.shape
    for j in range(n):
        value, rate = coefs[top - 1, j], 0.0
        for k in range(top - 2, -1, -1):
            rate = rate * s + value
            value = value * s + coefs[k, j]
        inputs[j], rates[j] = value, rate


def form_load(linear: LinearSystem, inputs: Array, out: Array) -> None:
    """Compute the loads on the unknowns for given inputs."""
    for i in range(len(out)):
        out[i] = linear.constant[i]
    for j in range(len(inputs)):
        for i in range(len(out)):
            out[i] += linear.inputs[j, i] * inputs[j]


def copy(x: Array, out: Array) -> None:
    """Copy a vector."""
    for i in range(len(x)):
        out[i] = x[i]


def multiply(a: Product, x: Array, out: Array) -> None:
    """Compute the product of a matrix with a vector."""
    n = len(x)
    for i in range(n):
        out[i] = a.diagonals[0, i] * x[i]
    for z in range(1, len(a.offsets)):
        first, size = max(0, -a.offsets[z]), n - abs(a.offsets[z])
        near, far = out[first : first + size], x[first + a.offsets[z] :]
        for i in range(size):
            near[i] += a.diagonals[z, i] * far[i]
    for r in range(len(a.row)):
        total = 0.0
        for j in range(a.pointers[r], a.pointers[r + 1]):
            total += a.values[j] * x[a.columns[j]]
        out[a.row[r]] += total


def row_product(rows: Rows, i: int, x: Array) -> float:
    """Return the product of one sparse row with a vector."""
    total = 0.0
    for j in range(rows.pointers[i], rows.pointers[i + 1]):
        total += rows.values[j] * x[rows.columns[j]]
    return total


def row_magnitude(rows: Rows, i: int, x: Array) -> float:
    """Return the sum of the magnitudes of the terms of one sparse row times a vector."""
    total = 0.0
    for j in range(rows.pointers[i], rows.pointers[i + 1]):
        total += abs(rows.values[j] * x[rows.columns[j]])
    return total


def add_row(rows: Rows, i: int, factor: float, out: Array) -> None:
    """Add `factor` times one sparse row to a vector."""
    for j in range(rows.pointers[i], rows.pointers[i + 1]):
        out[rows.columns[j]] += factor * rows.values[j]
