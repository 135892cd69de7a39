"""Mirror images: rules are written once, for the positive side, and mirrored for the negative side.

Side ``s`` is +1 or -1; a mirrored deformation is ``s d`` and a mirrored force is ``s f``.  The mirror image
of ``f = k d + f0`` is ``f = k d + s f0``.  Branches come in pairs: an odd number for the positive side, and
the next number for the negative side.
"""

from __future__ import annotations


def side(at: int) -> float:
    """Return the side of a branch."""
    return 1.0 if at % 2 == 1 else -1.0


def on_side(first: int, s: float) -> int:
    """Return the branch of side `s`; `first` is the branch of the positive side."""
    return first if s > 0.0 else first + 1


def both_sides(*names: str) -> tuple[str, ...]:
    """Return the names of pairs of branches: for each, the positive side, then the negative side."""
    return tuple(f"{name} {sign}" for name in names for sign in "+-")


def outward(s: float, d: float) -> tuple[float, float, float]:
    """Return the event function of a mirrored deformation that rises above `d`."""
    return (s, 0.0, -d)


def inward(s: float, d: float) -> tuple[float, float, float]:
    """Return the event function of a mirrored deformation that falls below `d`."""
    return (-s, 0.0, d)


def turns_inward(s: float) -> tuple[float, float, float]:
    """Return the event function of a reversal towards the other side."""
    return (0.0, -s, 0.0)


def turns_outward(s: float) -> tuple[float, float, float]:
    """Return the event function of a reversal towards this side."""
    return (0.0, s, 0.0)


def need_both_sides(fy_plus: float, fy_minus: float) -> None:
    """Raise an error for a zero yield force, for rules that divide by the yield deformation."""
    if not fy_minus < 0.0 < fy_plus:
        raise ValueError("this rule needs a yield force other than zero on both sides")
