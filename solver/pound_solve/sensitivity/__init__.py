"""Exact derivatives of a response by PARAMs of its deck."""

from pound_solve.sensitivity.response import Derivatives, derivatives
from pound_solve.sensitivity.refusal import NoDerivativeError

__all__ = ("Derivatives", "NoDerivativeError", "derivatives")
