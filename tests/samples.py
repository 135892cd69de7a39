"""Samples for tests from the Specs of the catalog: what is new is tested without a list to mend."""

from __future__ import annotations

from pound_deck.schema import Spec
from pound_solve.assess.law_test import LawTestError, specimen
from pound_solve.catalog import catalog


def items(spec: Spec, force: float, deformation: float) -> dict[str, tuple[float, ...] | str]:
    """Items of the Spec's `sample`, which is for yield at the force and the deformation one, for others."""
    factors = {"F": force, "L": deformation, "F/L": force / deformation}
    found: dict[str, tuple[float, ...] | str] = {}
    for item in spec.sample.split():
        name, _, text = item.partition("=")
        field = spec.field(name)
        assert field is not None, f"{spec.name}: its sample names {name}, which it has not"
        if field.words:
            found[name] = text
        else:
            found[name] = tuple(factors.get(field.unit, 1.0) * float(x) for x in text.split(","))
    return found


def written(spec: Spec, force: float, deformation: float) -> str:
    """The same as text of a card."""
    return " ".join(
        f"{name}={x if isinstance(x, str) else ','.join(f'{y:.12g}' for y in x)}"
        for name, x in items(spec, force, deformation).items()
    )


def values(spec: Spec, force: float, deformation: float) -> dict[str, object]:
    """The same as values of a card, without those that it leaves out."""
    found: dict[str, object] = {}
    for name, x in items(spec, force, deformation).items():
        field = spec.field(name)
        found[name] = x[0] if field is not None and field.count == (1, 1) and not field.words else x
    return found


def stepping_methods() -> list[str]:
    """Names of the methods that take time steps."""
    family = catalog().family("method")
    return [name for name, spec in family.items() if spec.impl.__module__.count(".stepping.")]


def has_loop(spec: Spec) -> bool:
    """Whether a rule or contact law has a loop to draw: ELASTIC and rigid contacts have none."""
    try:
        specimen(spec)
    except LawTestError:
        return False
    return True
