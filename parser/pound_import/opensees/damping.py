"""Damping: Rayleigh's factors of the model and of its regions, and modal ratios.

A factor on the stiffness acts on the elements that there are when the command stands, but for those without
length of their own and bars, which take part only with ``-doRayleigh``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from pound_deck.diagnostics import Mistake
from pound_deck.model import Span
from pound_import.draft import Draft, number, numbers
from pound_import.opensees.commands import Command, Flags, options
from pound_import.opensees.model import Damping, ScriptModel
from pound_import.opensees.new_deck import NewDeck

_ASKED = ("zeroLength", "zeroLengthSection", "twoNodeLink", "truss", "Truss", "corotTruss", "CorotTruss")


class Factors:
    """Rayleigh's factors by node and element.

    Parameters
    ----------
    model : ScriptModel
    draft : Draft
        Takes the mistakes.

    Attributes
    ----------
    masses : dict of int to float
        Factor on the mass of each node [1/T].
    stiffnesses : dict of int to str
        Items of the damping by the stiffness of each element.
    """

    def __init__(self, model: ScriptModel, draft: Draft) -> None:
        self._model, self._draft = model, draft
        self.masses: dict[int, float] = {}
        self.stiffnesses: dict[int, str] = {}
        self._modal: Command | None = None
        self._place: Span | None = None
        for damping in model.damping:
            with draft.keeping():
                self._take(damping)

    def _take(self, damping: Damping) -> None:
        command = damping.command
        if command.name == "modalDamping":
            self._modal = command
            return
        elements: Iterable[int] = damping.elements
        nodes: Iterable[int] = damping.nodes
        factors = [command.real(k, "a factor") for k in range(1, 5)] if command.name == "rayleigh" else []
        if command.name == "region":
            factors = options(command, 2).reals("-rayleigh")
            if len(factors) != 4:
                raise command.mistake("-rayleigh needs four factors", code="L620")
            elements, nodes = _region(self._model, damping)
        mass, tangent, initial, committed = factors
        if min(factors) < 0.0:
            raise command.mistake("a factor of rayleigh is negative", code="L620")
        self._place = command.span
        self.masses.update(dict.fromkeys(nodes, mass))
        tangent += committed
        if tangent and initial:
            raise command.mistake("rayleigh by the tangent and by the initial stiffness at once")
        words = f"BETA={number(tangent or initial)}" + (" STIFFNESS=TANGENT" if tangent else "")
        for tag in elements:
            if _takes_part(self._model.elements[tag]):
                self.stiffnesses[tag] = words if tangent or initial else ""

    def write(self, deck: NewDeck) -> None:
        """Write the cards; after the elements, whose labels they name."""
        if self._modal is not None:
            self._write_modal(self._modal)
        if self._place is None:
            return
        heavy = [tag for tag, mass in deck.masses.items() if any(mass)]
        masses = {self.masses.get(tag, 0.0) for tag in heavy}
        betas = {words: labels for words, labels in deck.damped.items() if words}
        everywhere = len(betas) == 1 and "" not in deck.damped
        if len(masses) == 1 and everywhere:
            ((words, _),) = betas.items()
            self._add(f"RAYLEIGH ALPHA={number(masses.pop())} {words}")
            return
        for alpha in sorted(masses - {0.0}):
            members = [tag for tag in heavy if self.masses.get(tag) == alpha]
            nodes = "" if len(masses) == 1 else f" NODES={deck.nodes(members)}"
            self._add(f"RAYLEIGH ALPHA={number(alpha)} BETA=0{nodes}")
        for words, labels in betas.items():
            self._add(f"RAYLEIGH ALPHA=0 {words}" + ("" if everywhere else f" PROPS={','.join(labels)}"))

    def _add(self, words: str) -> None:
        assert self._place
        self._draft.add("DAMPING", words, self._place)

    def _write_modal(self, command: Command) -> None:
        try:
            ratios = [command.real(k, "a ratio") for k in range(1, len(command.words))]
        except Mistake as mistake:
            mistake.keep(self._draft.report)
            return
        count = self._model.modes[-1][0] if self._model.modes else len(ratios)
        ratios = ratios * count if len(ratios) == 1 else ratios
        self._draft.add("DAMPING", f"MODAL XI={numbers((*ratios, 0.0))}", command.span)


def _takes_part(command: Command) -> bool:
    """Whether damping by stiffness acts on an element."""
    if command.word(1, "its type") not in _ASKED:
        return True
    choice = options(command, 5)
    return "-doRayleigh" in choice.flags and choice.flags["-doRayleigh"][:1] != ("0",)


def _region(model: ScriptModel, damping: Damping) -> tuple[Iterable[int], Iterable[int]]:
    """Elements and nodes of a region.

    With ``-ele`` it has the nodes of its elements, with ``-node`` the elements between its nodes;
    ``-eleOnly`` and ``-nodeOnly`` have no others.
    """
    choice = options(damping.command, 2)
    elements = {*_chosen(choice, "ele", damping.elements)}
    nodes = {*_chosen(choice, "node", damping.nodes)}
    joined = {tag: _ends(model.elements[tag]) for tag in damping.elements}
    if any(flag in choice.flags for flag in ("-ele", "-eleRange")):
        nodes |= {end for tag in elements if tag in joined for end in joined[tag]}
    if any(flag in choice.flags for flag in ("-node", "-nodeRange")):
        elements |= {tag for tag, both in joined.items() if set(both) <= nodes}
    return elements & set(damping.elements), nodes & set(damping.nodes)


def _ends(command: Command) -> tuple[int, ...]:
    return command.whole(3, "the first node"), command.whole(4, "the second node")


def _chosen(choice: Flags, kind: str, there: Iterable[int]) -> Iterator[int]:
    """Tags that the flags of a kind name."""
    for flag in (f"-{kind}", f"-{kind}Only"):
        if choice.flags.get(flag) == ("all",):
            yield from there
        else:
            yield from choice.wholes(flag)
    for flag in (f"-{kind}Range", f"-{kind}OnlyRange"):
        limits = choice.wholes(flag)
        if len(limits) == 2:
            yield from (tag for tag in there if limits[0] <= tag <= limits[1])
