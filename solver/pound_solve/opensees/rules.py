"""Hysteresis rules that OpenSees has as well, each as the material that equals it.

Adding a rule is one entry of `RULES`.  A rule without an entry is refused by its name.

References
----------
OpenSees documentation, uniaxialMaterial Steel01, ElasticPP, Parallel, SelfCentering, Steel02,
BoucWen.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Final

from pound_solve.laws.hysteresis.backbone import loses_strength
from pound_solve.laws.refusal import ItemError
from pound_solve.opensees.script import Material

#: makes a material from the items of a card, a stiffness and both strengths
Translation = Callable[[Mapping[str, Any], float, float, float], Material]


def elastic(k: float) -> Material:
    """Return an elastic material."""
    return Material("Elastic", (k,))


def elasto_plastic(values: Mapping[str, Any], k: float, plus: float, minus: float) -> Material:
    """Return ElasticPP with yield strains of both sides."""
    _without_loss(values)
    return Material("ElasticPP", (k, plus / k, minus / k, 0.0))


def bilinear(values: Mapping[str, Any], k: float, plus: float, minus: float) -> Material:
    """Return Steel01, or for two yield forces or softening an elastic beside a plastic material."""
    r = values["R"]
    if r == 0.0:
        return elasto_plastic(values, k, plus, minus)
    _without_loss(values)
    if plus == -minus and r > 0.0:
        return Material("Steel01", (plus, k, r))
    plastic = Material("ElasticPP", ((1.0 - r) * k, plus / k, minus / k, 0.0))
    return Material("Parallel", (), (elastic(r * k), plastic))


def flag_shaped(values: Mapping[str, Any], k: float, plus: float, minus: float) -> Material:
    """Return SelfCentering."""
    _alike(plus, minus)
    return Material("SelfCentering", (k, values["R"] * k, plus, values["BETA"]))


def menegotto_pinto(values: Mapping[str, Any], k: float, plus: float, minus: float) -> Material:
    """Return Steel02."""
    _alike(plus, minus)
    items = ("R", "R0", "CR1", "CR2", "A1", "A2", "A3", "A4")
    return Material("Steel02", (plus, k, *(values[item] for item in items)))


def bouc_wen(values: Mapping[str, Any], k: float, plus: float, minus: float) -> Material:
    """Return BoucWen without degradation; it solves its equation by backward Euler."""
    _alike(plus, minus)
    n, beta = values["N"], values["BETA"]
    scale = (k / plus) ** n
    return Material("BoucWen", (values["R"], k, n, (1.0 - beta) * scale, beta * scale, 1.0, 0.0, 0.0, 0.0))


def _alike(plus: float, minus: float) -> None:
    """Raise ItemError if the strengths of both directions differ."""
    if plus != -minus:
        raise ItemError("this rule with two strengths", "RULE")


def _without_loss(values: Mapping[str, Any]) -> None:
    """Raise ItemError if the strength falls."""
    if loses_strength(values):
        raise ItemError("strength that falls with ductility or cycles", "ILOS")


RULES: Final[Mapping[str, Translation]] = MappingProxyType(
    {
        "ELASTO_PLASTIC": elasto_plastic,
        "BILINEAR": bilinear,
        "FLAG_SHAPED": flag_shaped,
        "MENEGOTTO_PINTO": menegotto_pinto,
        "BOUC_WEN": bouc_wen,
    }
)
