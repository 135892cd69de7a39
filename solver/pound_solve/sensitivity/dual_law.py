"""Derivatives of the laws: their branches and transitions evaluated with dual numbers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from pound_solve.laws.automaton import EVENTS, NEVER
from pound_solve.numerics.types import Array
from pound_solve.sensitivity.dual import Dual, Term, slopes_of, value_of
from pound_solve.sensitivity.refusal import NoDerivativeError
from pound_solve.structure.elements.base import LawSpring


class DualLaw:
    """A law, its parameters and its internal variables as dual numbers, along a run.

    Parameters
    ----------
    spring : LawSpring
    p : tuple of Dual
        Parameters.
    beta, secant : Dual
        Of its dashpot (see `LawSpring`).
    at : int
        Branch at the start.
    m : tuple of Dual
        Internal variables at the start.
    """

    def __init__(
        self, spring: LawSpring, p: Any, beta: Dual, secant: Dual, at: int, m: tuple[Any, ...]
    ) -> None:
        self.spring, self.p, self.beta, self.secant = spring, p, beta, secant
        self.at, self.m = at, m
        self._enter()

    def _enter(self) -> None:
        """Evaluate the present branch."""
        terms: Any = self.spring.law.rule.branch(self.p, self.at, self.m)
        k, c, f0, *flat = terms
        if self.beta.value or self.secant.value:
            c = c + self.beta * max(k, 0.0)
            if self.secant.value:
                c = c + self.secant * self.m[-1]
        self.stiffness: Term = k
        self.damping: Term = c
        self.force0: Term = f0
        self.events = [tuple(flat[i : i + 3]) for i in range(0, 3 * EVENTS, 3)]

    def event(self, index: int) -> tuple[Term, Term, Term]:
        """Return the factors on the deformation and on the rate, and the constant, of an event function."""
        on_d, on_v, constant = self.events[index]
        assert (on_d, on_v, constant) != NEVER
        return on_d, on_v, constant

    def change(self, event: int, d: Dual, v: Dual, after: int) -> None:
        """Leave the branch at an event, with the derivatives of deformation `d` and rate `v` at the instant
        of the event, for the branch `after`.

        Raises
        ------
        NoDerivativeError
            The rule has no derivative: it uses a function that dual numbers do not have.
        """
        try:
            at, m = self.spring.law.rule.transition(self.p, self.at, self.m, event, d, v)  # type: ignore
        except (TypeError, ValueError, ZeroDivisionError, OverflowError) as err:
            rule, element = self.spring.rule, self.spring.element
            raise NoDerivativeError(
                f"the rule {rule} of element {element} has no derivative: {err}"
            ) from None
        if at != after:
            raise NoDerivativeError(
                f"element {self.spring.element} ({self.spring.rule}) changes its branch in a way that "
                "rounding decides"
            )
        self.at, self.m = at, m
        self._enter()


class BranchSlopes(NamedTuple):
    """Branches of all laws, and their derivatives: stiffness, damping and constant of each.

    Attributes
    ----------
    values : ndarray, shape (3, n_laws)
    slopes : ndarray, shape (3, n_params, n_laws)
    """

    values: Array
    slopes: Array


def branch_slopes(laws: Iterable[DualLaw], n_params: int) -> BranchSlopes:
    """Return the present branches of all laws with their derivatives."""
    terms = [(x.stiffness, x.damping, x.force0) for x in laws]
    values = np.array([[value_of(x) for x in term] for term in terms]).reshape(-1, 3).T
    slopes = np.zeros((3, n_params, len(terms)))
    for i, term in enumerate(terms):
        for order, x in enumerate(term):
            slopes[order, :, i] = slopes_of(x)
    return BranchSlopes(values, slopes)
