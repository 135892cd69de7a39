r"""A hysteretic law that keeps its secant stiffness as an internal variable.

.. math:: k_s = \frac{f_t}{d_t}

where :math:`(d_t, f_t)` is the reversal farthest from :math:`d = 0`; before the first reversal it is the
initial stiffness.  At a reversal the rate is zero, so a dashpot has no force and can follow :math:`k_s`
without a jump.
"""

from __future__ import annotations

from pound_solve.laws.automaton import K, Law, State


class SecantLaw(Law):
    """A law with two more internal variables, which its rule ignores: the deformation of the farthest
    reversal, and the secant stiffness.
    """

    def start(self) -> State:
        """Return the virgin state at zero deformation."""
        at, d0, work, m = super().start()
        return at, d0, work, (*m, 0.0, self.p[K])

    def transition(self, state: State, event_index: int, d: float, v: float = 0.0) -> State:
        """Return the state after that event of the branch, at deformation `d` and rate `v`."""
        *internal, farthest, secant = state[3]
        on_d, _, constant = self.branch(state).events[event_index]
        if on_d == 0.0 == constant and abs(d) > farthest:
            farthest, secant = abs(d), max(self.force(state, d)[0] / d, 0.0)
        at, d0, work, m = super().transition((*state[:3], tuple(internal)), event_index, d, v)
        return at, d0, work, (*m, farthest, secant)
