r"""A law whose deformation excludes an elastic part that the adjacent structure already includes.

The elastic part :math:`g f` is removed from the deformation :math:`x` of a law :math:`f = k x + f_0`:

.. math:: d = x - g f, \qquad f = \frac{k d + f_0}{1 - g k}, \qquad x = \frac{d + g f_0}{1 - g k}

Every branch remains a straight line, and every event occurs at the same force; :math:`g k < 1` must hold on
all branches.  A hinge of length :math:`L_p` is such a law: its section also bends elastically, by
:math:`L_p / EI` per unit moment.  The beam behind it, modelled with the full length of the member, already
contains that part (`structure.elements.frame`).

The parameters are those of the law, followed by :math:`g`; the internal variables are those of the law.

References
----------
Giberson MF (1967), The response of nonlinear multi-story structures subjected to earthquake excitation,
Earthquake Engineering Research Laboratory, California Institute of Technology, Pasadena (springs at the
ends of an elastic member, which take the inelastic part of the rotation).
"""

from __future__ import annotations

from functools import cache
from typing import Any

from pound_solve.laws.automaton import K, Law, Numbers, Rule
from pound_solve.laws.functions import bound, missing
from pound_solve.numerics.jit import Function

STEEP = 0.99  #: largest g k; in terms of d a branch is then at most a hundred times as steep

# `bound` sets this separately for each copy of the functions below
rule_branch: Any = missing
rule_transition: Any = missing
rule_recoverable: Any = missing
place = 0  #: index of g among the parameters, after those of the rule


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch as a function of the remaining deformation, without the elastic part."""
    g = p[place]
    k, c, f0, a1, b1, c1, a2, b2, c2, a3, b3, c3 = rule_branch(p[:place], at, m)
    s = 1.0 / (1.0 - g * k)
    shift = s * g * f0
    first = (s * a1, s * b1, c1 + a1 * shift)
    second = (s * a2, s * b2, c2 + a2 * shift)
    third = (s * a3, s * b3, c3 + a3 * shift)
    return (s * k, c, s * f0, *first, *second, *third)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a transition of the original rule, at the total deformation."""
    g = p[place]
    k, _, f0 = rule_branch(p[:place], at, m)[:3]
    s = 1.0 / (1.0 - g * k)
    after: tuple[int, Numbers] = rule_transition(p[:place], at, m, event, s * (d + g * f0), s * v)
    return after


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the recoverable energy minus that of the elastic part."""
    g = p[place]
    energy: float = rule_recoverable(p[:place], at, m, d + g * f, f) - 0.5 * g * f * f
    return energy


@cache
def condensed(rule: Rule) -> Rule:
    """Return the rule with `g` as an additional last parameter.

    Raises
    ------
    ValueError
        The branches of the rule are not straight.
    """
    if rule.curve is not None:
        raise ValueError("the branches of this rule are curves")
    n = rule.parameters

    def start(p: Numbers) -> tuple[int, Numbers]:
        return rule.start(p[:n])

    def steepest(p: Numbers) -> float:
        k = rule.steepest(p[:n])
        return k / (1.0 - p[n] * k)

    functions = {
        "rule_branch": rule.branch,
        "rule_transition": rule.transition,
        "rule_recoverable": rule.recoverable,
    }

    def bound_to_rule(template: Function, function: Function) -> Function:
        return bound(template, f"{function.__module__}.{function.__qualname__}-{n}", place=n, **functions)

    return Rule(
        rule.branches,
        start,
        bound_to_rule(branch, rule.branch),
        bound_to_rule(transition, rule.transition),
        bound_to_rule(recoverable, rule.recoverable),
        steepest=steepest,
        parameters=n + 1,
        variables=rule.variables,
    )


def without(law: Law, elastic_share: float) -> Law:
    """Return the law without the given share of its initial elastic deformation.

    Raises
    ------
    ValueError
        The branches are not straight, or one may be so steep that no deformation remains on it.
    """
    g = elastic_share / law.p[K]
    if law.rule.curve is None and g * law.rule.steepest(law.p) >= STEEP:
        raise ValueError("this rule unloads too steeply")
    return Law(condensed(law.rule), (*law.p, g))
