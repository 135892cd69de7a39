"""Exact derivatives of a response by PARAMs of its deck."""

from pound_solve.sensitivity.refusal import NoDerivativeError
from pound_solve.sensitivity.response import Derivatives, derivatives

__all__ = ("Derivatives", "NoDerivativeError", "derivatives")
