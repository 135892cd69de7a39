"""Uniaxial materials of OpenSees: the hysteresis rule, contact law or dashpot that equals each.

Adding a material is one function and one entry of `MATERIALS`.  A material without an entry is refused by
its name.  Materials of OpenSees work in compression: gaps and yield forces of that side are negative.

References
----------
OpenSees documentation, commands uniaxialMaterial.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Final

from pound_deck.diagnostics import Mistake
from pound_import.draft import Draft, number
from pound_import.opensees.commands import Command
from pound_import.opensees.model import ScriptModel
from pound_import.opensees.parts import GapPart, Items, Part, SpringPart, ViscousPart, alike

Values = Sequence[float]


class Materials:
    """Materials of a model, each read once.

    Parameters
    ----------
    model : ScriptModel
    draft : Draft
        Takes what is read by convention.
    """

    def __init__(self, model: ScriptModel, draft: Draft) -> None:
        self._model, self._draft = model, draft
        self._read: dict[int, tuple[Part, ...] | None] = {}

    def parts(self, tag: int, user: Command) -> tuple[Part, ...]:
        """Parts that act side by side.

        Parameters
        ----------
        tag : int
        user : Command
            That names the material.

        Raises
        ------
        Mistake
            There is no such material, or no rule or law equals it.
        """
        if tag not in self._read:
            command = self._model.item("the material", self._model.materials, tag, user)
            self._read[tag] = None  # one that fails, or holds itself, is reported once
            self._read[tag] = tuple(self._translated(command))
        parts = self._read[tag]
        if parts is None:
            raise Mistake
        return parts

    def spring(self, tag: int, user: Command, where: str) -> SpringPart:
        """Single spring that a material is; raises as `parts`, also for another one."""
        parts = self.parts(tag, user)
        if len(parts) == 1 and isinstance(parts[0], SpringPart):
            return parts[0]
        if parts and all(isinstance(part, SpringPart) and part.rule == "ELASTIC" for part in parts):
            return SpringPart(sum(part.k for part in parts if isinstance(part, SpringPart)))
        raise user.mistake(f"material {tag} is more than one spring, which {where} does not have")

    def doubt(self, command: Command, reading: str) -> str:
        """Warn of a reading by convention; return its comment."""
        return self._draft.doubt(command.span, reading)

    def lose(self, command: Command, what: str) -> str:
        """Warn of what is not carried over; return its comment."""
        return self._draft.lose(command.span, what)

    def _translated(self, command: Command) -> Sequence[Part]:
        name = command.word(1, "the type")
        if name not in MATERIALS:
            hint = "use one of " + ", ".join(sorted(MATERIALS))
            raise command.no_counterpart(name, MATERIALS, hint)
        return MATERIALS[name](self, command)


def values(command: Command, least: int, most: int) -> list[float]:
    """Numbers behind the tag.

    Raises
    ------
    Mistake
        There are fewer than `least`, or more than `most`, or one is no number.
    """
    count = len(command.words) - 3
    if not least <= count <= most:
        what = f"{count} numbers, not {least}" + (f" to {most}" if most > least else "")
        raise command.mistake(f"{' '.join(command.words[:3])[:60]}: {what}", code="L620")
    return [command.real(k, "a number") for k in range(3, len(command.words))]


def positive(command: Command, names: str, numbers: Values) -> None:
    """Raise a Mistake unless these numbers are above 0."""
    for name, value in zip(names.split(), numbers):
        if value <= 0.0:
            what = f"{' '.join(command.words[:3])[:60]}: {name} is {value:g}, not above 0"
            raise command.mistake(what, code="L620")


def without(command: Command, what: str, given: bool) -> None:
    """Raise a Mistake if an option that has no counterpart is given."""
    if given:
        raise command.mistake(f"{' '.join(command.words[:3])[:60]}: {what} has no counterpart here")


def _elastic(materials: Materials, command: Command) -> Sequence[Part]:
    given = values(command, 1, 3)
    e, eta, negative = (*given, *(0.0, given[0])[len(given) - 1 :])
    without(command, "a second stiffness in compression", negative != e)
    if e < 0.0 or eta < 0.0:
        raise command.mistake(f"{' '.join(command.words[:3])[:60]}: E or eta is below 0", code="L620")
    return [*([SpringPart(e)] if e else []), *([ViscousPart(eta)] if eta else [])]


def _elastic_plastic(materials: Materials, command: Command) -> Sequence[Part]:
    e, plus, *rest = values(command, 2, 4)
    minus = rest[0] if rest else -plus
    without(command, "an initial strain", len(rest) > 1 and rest[1] != 0.0)
    positive(command, "E epsyP -epsyN", [e, plus, -minus])
    return [SpringPart(e, (e * plus, e * minus), "ELASTO_PLASTIC")]


def _steel01(materials: Materials, command: Command) -> Sequence[Part]:
    strength, e, b, *hardening = values(command, 3, 7)
    without(command, "isotropic hardening (a1 to a4)", any(hardening[::2]))
    return [bilinear(command, e, (strength, -strength), b)]


def bilinear(command: Command, e: float, strength: tuple[float, float], b: float) -> SpringPart:
    """Spring with kinematic hardening; raises a Mistake for impossible numbers."""
    positive(command, "Fy E -Fy", [strength[0], e, -strength[1]])
    if not b < 1.0:
        raise command.mistake(f"the ratio of stiffnesses is {b:g}, not below 1", code="L620")
    if b == 0.0:
        return SpringPart(e, strength, "ELASTO_PLASTIC")
    return SpringPart(e, strength, "BILINEAR", (("R", (b,)),))


def _hardening(materials: Materials, command: Command) -> Sequence[Part]:
    e, strength, isotropic, kinematic, *eta = values(command, 4, 5)
    without(command, "isotropic hardening", isotropic != 0.0)
    without(command, "viscosity", any(eta))
    return [bilinear(command, e, (strength, -strength), kinematic / (e + kinematic))]


def _steel02(materials: Materials, command: Command) -> Sequence[Part]:
    defaults = (20.0, 0.925, 0.15, 0.0, 1.0, 0.0, 1.0, 0.0)
    given = values(command, 3, 11)
    strength, e, b, *shape = [*given, *defaults[len(given) - 3 :]]
    without(command, "an initial stress", shape[7] != 0.0)
    positive(command, "Fy E", [strength, e])
    names = ("R", "R0", "CR1", "CR2", "A1", "A2", "A3", "A4")
    items: Items = tuple((name, (x,)) for name, x in zip(names, (b, *shape)))
    return [SpringPart(e, (strength, -strength), "MENEGOTTO_PINTO", items)]


def _tension_free(materials: Materials, command: Command) -> Sequence[Part]:
    (e,) = values(command, 1, 1)
    positive(command, "E", [e])
    return [GapPart(0.0, stiffness=e)]


def _gap(materials: Materials, command: Command) -> Sequence[Part]:
    words = tuple(word for word in command.words if word not in ("damage", "noDamage"))
    e, strength, gap, *_ = values(replace(command, words=words), 3, 4)
    positive(command, "E", [e])
    without(command, "signs of Fy and gap that differ", gap * strength < 0.0)
    notes: tuple[str, ...] = ()
    if abs(strength) < _NEVER * e:
        what = f"the yield force {number(strength)} of the gap: the contact stays elastic"
        notes = (materials.lose(command, what),)
    return [GapPart(abs(gap), stiffness=e, pulls=strength > 0.0, notes=notes)]


_NEVER: Final = 1e3  #: overlap at which a gap yields that is meant not to, in any unit of length


def _viscoelastic_gap(materials: Materials, command: Command) -> Sequence[Part]:
    k, c, gap = values(command, 3, 3)
    positive(command, "K -gap", [k, -gap])
    return [GapPart(-gap, f"KELVIN_VOIGT K={number(k)} C={number(c)} TENSION=YES")]


def _impact(materials: Materials, command: Command) -> Sequence[Part]:
    k1, k2, dy, gap = values(command, 4, 4)
    positive(command, "K1 K2 -delta_y", [k1, k2, -dy])
    return [GapPart(abs(gap), f"BILINEAR_IMPACT K1={number(k1)} K2={number(k2)} DY={number(-dy)}")]


def _hertzdamp(materials: Materials, command: Command) -> Sequence[Part]:
    k, xi, gap, *n = values(command, 3, 4)
    positive(command, "Kh -gap", [k, -gap])
    power = n[0] if n else 1.5
    law = "HERTZDAMP" if power == 1.5 else "HUNT_CROSSLEY"
    exponent = "" if power == 1.5 else f" N={number(power)}"
    return [GapPart(-gap, f"{law} K={number(k)} D={number(xi)}{exponent}")]


def _jankowski(materials: Materials, command: Command) -> Sequence[Part]:
    k, xi, mass, gap, *n = values(command, 4, 5)
    positive(command, "Kh Meff -gap", [k, mass, -gap])
    without(command, "an exponent other than 1.5", bool(n) and n[0] != 1.5)
    return [GapPart(-gap, f"JANKOWSKI K={number(k)} XI={number(xi)}", masses=2.0 * mass)]


def _viscous(materials: Materials, command: Command) -> Sequence[Part]:
    c, alpha, *_ = values(command, 2, 3)
    positive(command, "C alpha", [c, alpha])
    return [ViscousPart(c, alpha)]


def _self_centring(materials: Materials, command: Command) -> Sequence[Part]:
    k1, k2, strength, beta, *slip = values(command, 4, 7)
    without(command, "slip or bearing", any(slip))
    positive(command, "k1 sigAct beta", [k1, strength, beta])
    items: Items = (("R", (k2 / k1,)), ("BETA", (beta,)))
    return [SpringPart(k1, (strength, -strength), "FLAG_SHAPED", items)]


def _bouc_wen(materials: Materials, command: Command) -> Sequence[Part]:
    alpha, k, n, gamma, beta, scale, *degrading = values(command, 9, 11)
    without(command, "degradation", any(degrading[:3]))
    without(command, "Ao other than 1", scale != 1.0)
    positive(command, "ko n beta+gamma", [k, n, beta + gamma])
    strength = k * (beta + gamma) ** (-1.0 / n)
    items: Items = (("R", (alpha,)), ("N", (n,)), ("BETA", (beta / (beta + gamma),)))
    return [SpringPart(k, (strength, -strength), "BOUC_WEN", items)]


def _imk(rule: str, pinched: int) -> Callable[[Materials, Command], Sequence[Part]]:
    """Return the reader of an IMK material; `pinched` counts its parameters of pinching."""

    def read(materials: Materials, command: Command) -> Sequence[Part]:
        modes = 3 if rule == "IMK_BILINEAR" else 4
        k, *given = values(command, *[15 + 2 * modes + pinched] * 2)
        sides, losses = given[:12], given[12 : 12 + 2 * modes]
        (up, upc, uu, fy, cap, residual), (un, unc, unu, fn, cap_n, residual_n) = sides[:6], sides[6:]
        rates, last = losses[:modes], given[12 + 2 * modes :]
        if modes == 4:  # OpenSees states reloading before unloading
            rates = [*rates[:2], rates[3], rates[2]]
        positive(command, "Ke dp dpc du Fy dp dpc du Fy", [k, up, upc, uu, fy, un, unc, unu, abs(fn)])
        ratio, ratio_n = (cap - 1.0) * fy / up / k, (cap_n - 1.0) * abs(fn) / un / k
        what = "sides of unlike hardening, residual strength, exponents or rates of deterioration"
        unlike = not math.isclose(ratio, ratio_n, rel_tol=1e-9, abs_tol=1e-12) or residual != residual_n
        exponents = set(losses[modes:])
        rates_of_sides = last[:2]
        without(command, what, unlike or len(exponents) > 1 or rates_of_sides != [1.0, 1.0])
        items = [("R", (ratio,)), ("RESIDUAL", (residual,)), ("C", (exponents.pop(),))]
        items += [(name, (x,)) for name, x in zip(("KAPPAF", "KAPPAD"), last[2:])]
        lengths = [("DP", (up, un)), ("DPC", (upc, unc)), ("DU", (uu, unu)), ("LAMBDA", tuple(rates))]
        note = materials.doubt(command, f"{rule} is the rule of this material but for double reversals")
        return [
            SpringPart(
                k,
                (fy, -abs(fn)),
                rule,
                tuple(items),
                tuple((name, alike(x)) for name, x in lengths),
                (note,),
            )
        ]

    return read


def _hysteretic(materials: Materials, command: Command) -> Sequence[Part]:
    given = values(command, 12, 17)
    points, rest = (given[:8], given[8:]) if len(given) < 16 else (given[:12], given[12:])
    half = len(points) // 2
    plus = list(zip(points[:half:2], points[1:half:2]))
    minus = list(zip(points[half::2], points[half + 1 :: 2]))
    pinch_x, pinch_y, damage1, damage2, beta = [*rest, 0.0][:5]
    without(command, "pinching", (pinch_x, pinch_y) != (1.0, 1.0))
    without(command, "damage", bool(damage1 or damage2))
    (f1, d1), (g1, e1) = plus[0], minus[0]
    positive(command, "s1p e1p -s1n -e1n", [f1, d1, -g1, -e1])
    k = f1 / d1
    slopes = [
        (b[0] - a[0]) / (b[1] - a[1]) / k if b[1] != a[1] else math.nan
        for side in (plus, minus)
        for a, b in pairwise(side)
    ]
    ratio = slopes[0]
    even = all(math.isclose(s, ratio, rel_tol=1e-6, abs_tol=1e-9) for s in slopes)
    without(command, "a backbone of more than two lines, or of unlike sides", not even)
    without(
        command, "a stiffness of the negative side of its own", not math.isclose(g1 / e1, k, rel_tol=1e-6)
    )
    without(command, "a backbone that falls", ratio < 0.0)
    items: Items = (("R", (max(ratio, 0.0),)), ("ALFA", (beta,)))
    return [SpringPart(k, (f1, g1), "CLOUGH", items)]


def _parallel(materials: Materials, command: Command) -> Sequence[Part]:
    without(command, "a list of factors", "-factors" in command.words)
    tags = [command.whole(k, "a tag") for k in range(3, len(command.words))]
    return [part for tag in tags for part in materials.parts(tag, command)]


def _wrapped(materials: Materials, command: Command) -> Sequence[Part]:
    note = materials.lose(
        command, f"the failure that {command.words[1]} adds to material {command.word(3, 'the tag')}"
    )
    parts = materials.parts(command.whole(3, "the tag"), command)
    return [replace(part, notes=(*part.notes, note)) for part in parts]


MATERIALS: Final[Mapping[str, Callable[[Materials, Command], Sequence[Part]]]] = {
    "Elastic": _elastic,
    "ElasticPP": _elastic_plastic,
    "Steel01": _steel01,
    "Steel02": _steel02,
    "Hardening": _hardening,
    "ENT": _tension_free,
    "ElasticPPGap": _gap,
    "ViscoelasticGap": _viscoelastic_gap,
    "ImpactMaterial": _impact,
    "Impact": _impact,
    "Hertzdamp": _hertzdamp,
    "JankowskiImpact": _jankowski,
    "Viscous": _viscous,
    "SelfCentering": _self_centring,
    "BoucWen": _bouc_wen,
    "IMKBilin": _imk("IMK_BILINEAR", 0),
    "IMKPeakOriented": _imk("IMK_PEAK_ORIENTED", 0),
    "IMKPinching": _imk("IMK_PINCHING", 2),
    "Hysteretic": _hysteretic,
    "Parallel": _parallel,
    "MinMax": _wrapped,
    "Fatigue": _wrapped,
}
