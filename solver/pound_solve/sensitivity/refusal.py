"""The refusal of a run that has no exact derivatives here."""

from __future__ import annotations

from pound_solve.user_error import UserError


class NoDerivativeError(UserError):
    """Raised if a run, or one of its PARAMs, has no exact derivative here; the message says why."""
