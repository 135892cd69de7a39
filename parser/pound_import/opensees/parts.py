"""Parts that a material of OpenSees becomes, as the new deck writes them: springs, dashpots, contacts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from pound_import.draft import number, numbers

Items = tuple[tuple[str, tuple[float, ...]], ...]  #: names of items with their values


@dataclass(frozen=True, slots=True)
class SpringPart:
    """A spring in one direction.

    Attributes
    ----------
    k : float
        Initial stiffness [F/L], or [F*L] of a rotation.
    strength : tuple of float
        Yield forces of the positive and the negative side; none: elastic.
    rule : str
    items : Items
        Of the rule, without unit.
    lengths : Items
        Of the rule, in units of the deformation.
    notes : tuple of str
        Comments.
    """

    k: float
    strength: tuple[float, ...] = ()
    rule: str = "ELASTIC"
    items: Items = ()
    lengths: Items = ()
    notes: tuple[str, ...] = ()

    def scaled(self, area: float, length: float) -> SpringPart:
        """Spring of a bar, of the material's law of stress and strain."""
        return replace(
            self,
            k=self.k * area / length,
            strength=tuple(f * area for f in self.strength),
            lengths=tuple((name, tuple(x * length for x in values)) for name, values in self.lengths),
        )

    def words(self) -> str:
        """Items of the rule."""
        return written((*self.items, *self.lengths))


@dataclass(frozen=True, slots=True)
class ViscousPart:
    """A dashpot with the force c v^alpha."""

    c: float
    alpha: float = 1.0
    notes: tuple[str, ...] = ()

    def scaled(self, area: float, length: float) -> ViscousPart:
        """Dashpot of a bar."""
        return replace(self, c=self.c * area / length**self.alpha)


@dataclass(frozen=True, slots=True)
class GapPart:
    """A contact.

    Attributes
    ----------
    gap : float
        [L]
    law : str
        Its law with its items.
    stiffness : float or None
        Of the law LINEAR, which the contact of a bar scales; None: other laws.
    pulls : bool
        Whether it acts in tension: the direction is that from J to I.
    masses : float or None
        Mass of the law; None: those of the nodes.
    notes : tuple of str
    """

    gap: float
    law: str = "LINEAR"
    stiffness: float | None = None
    pulls: bool = False
    masses: float | None = None
    notes: tuple[str, ...] = ()

    def scaled(self, area: float, length: float) -> GapPart | None:
        """Contact of a bar; None where its law has no such scale."""
        if self.stiffness is None:
            return None
        return replace(self, gap=self.gap * length, stiffness=self.stiffness * area / length)

    def words(self) -> str:
        """The law with its items."""
        return self.law if self.stiffness is None else f"LINEAR K={number(self.stiffness)}"


Part = SpringPart | ViscousPart | GapPart


def written(items: Iterable[tuple[str, tuple[float, ...]]]) -> str:
    """Items as a deck writes them."""
    return " ".join(f"{name}={numbers(values)}" for name, values in items)


def alike(values: Iterable[float]) -> tuple[float, ...]:
    """One value where all are equal, else all."""
    values = tuple(values)
    return values[:1] if len(set(values)) == 1 else values
