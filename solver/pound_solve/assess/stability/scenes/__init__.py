"""Stress scenes for the stability matrix, stiff and extreme, as decks: every contact law, every hysteresis
rule, and linear scenes whose motion is known in closed form.
"""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.assess.stability.scenes.case import StabilityCase
from pound_solve.assess.stability.scenes.contact import contact_scenes
from pound_solve.assess.stability.scenes.hysteresis import hysteresis_scenes
from pound_solve.assess.stability.scenes.linear import linear_scenes
from pound_solve.catalog import catalog


def cases(families: tuple[str, ...] = ("linear", "contact", "hysteresis")) -> Iterator[StabilityCase]:
    """All cases of some families."""
    if "linear" in families:
        yield from linear_scenes()
    for family, scenes in (("contact", contact_scenes), ("hysteresis", hysteresis_scenes)):
        if family in families:
            for spec in catalog().family(family).values():
                if spec.impl is not None:
                    yield from scenes(spec)
