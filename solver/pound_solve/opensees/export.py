"""Write a deck as a script for OpenSeesPy and the files of its ground motions."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final, NamedTuple

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Element
from pound_solve.driver.prepare import DeckError, Prepared
from pound_solve.laws.refusal import ItemError
from pound_solve.opensees import damping, frames, impacts, loads, motions, springs, supports, template
from pound_solve.opensees.peaks import ComparedItems, compared_items
from pound_solve.opensees.script import REFUSED, SECTIONS, Script, literal, table
from pound_solve.version import __version__

#: functions that write the elements of a kind; a kind without one is refused by its name
ELEMENTS: Final[Mapping[str, Callable[[Script, Element, Card], None]]] = MappingProxyType(
    {
        "FRAME": frames.frame,
        "SPRING": springs.spring,
        "DASHPOT": springs.dashpot,
        "CONTACT": springs.contact,
    }
)
PER_CONTACT = 100  #: steps in the half period of a closed contact
PER_SAMPLE = 4  #: least steps in the step of a record
STEPS = 20000  #: of a history without contacts
CLOSE = "no exact counterpart for OpenSees is known here"


class Exported(NamedTuple):
    """A deck as a script.

    Attributes
    ----------
    text : str
    files : mapping of str to str
        Texts of the files beside the script, by name.
    compared : ComparedItems
    step : float
        Time step that the script takes unless told otherwise [T].
    remark : str
        Where the models differ; empty if they do not.
    """

    text: str
    files: Mapping[str, str]
    compared: ComparedItems
    step: float
    remark: str

    def write(self, path: Path) -> list[Path]:
        """Write the script and its files, and return their paths."""
        from pound_solve.results.whole_file import write_text

        path.parent.mkdir(parents=True, exist_ok=True)
        paths = [path, *(path.parent / name for name in self.files)]
        for place, text in zip(paths, (self.text, *self.files.values())):
            write_text(place, text)
        return paths


def export(ready: Prepared, deck: str) -> Exported:
    """Translate a prepared deck.

    Parameters
    ----------
    ready : Prepared
    deck : str
        Path of the deck.

    Raises
    ------
    DeckError
        It contains what OpenSees has no exact counterpart of; every item is listed.
    UserError
        Two contacts have the same name.
    """
    script = Script(ready.structure.model, ready.structure)
    history = _history(script)
    supports.nodes(script)
    loads.nodal(script)
    for element in script.model.elements.values():
        _element(script, element, script.model.props[element.prop])
    damping.damping(script)
    motions.motions(script, ready.motions, Path(deck).stem)
    motions.velocities(script)
    motions.forces(script, ready.forces, Path(deck).stem)
    if history is None or script.refusals:
        raise DeckError([_worded(x) for x in sorted(script.refusals, key=_line)], ready.files)
    compared = compared_items(script.model)
    step = default_step(script, ready, history["T"])
    text = _text(script, compared, history["T"], step, Path(deck).name)
    laws = {card["LAW"] for card in script.model.props.values() if card.spec.name == "CONTACT"}
    return Exported(text, script.files, compared, step, impacts.remark(laws))


def _line(refusal: Diagnostic) -> tuple[str, int, int]:
    """Place of a refusal, for its order."""
    assert refusal.span is not None
    return refusal.span.file, refusal.span.line, refusal.span.column


def _worded(refusal: Diagnostic) -> Diagnostic:
    """Return a refusal as a whole sentence."""
    message = f"{CLOSE}: {refusal.message}"
    return Diagnostic(REFUSED, message, refusal.span, refusal.hint)


def _history(script: Script) -> Card | None:
    """Return the HISTORY card; refuse what a script cannot repeat."""
    cards = {card.spec.name: card for card in script.model.analyses}
    history = cards.get("HISTORY")
    if history is not None and "PUSHOVER" in cards:
        script.refuse("PUSHOVER", cards["PUSHOVER"].span, "leave it out: the script is a history")
    if history is None:
        place = script.model.analyses[0].span
        script.refuse("a deck without HISTORY", place, "add HISTORY")
        return None
    if history["RESTART"]:
        script.refuse("a history that continues another", history.place("RESTART"))
    if history["FROM"] == "REST" and script.structure.loads.any():
        script.refuse("loads applied suddenly (FROM=REST)", history.place("FROM"))
    return history


def _element(script: Script, element: Element, card: Card) -> None:
    """Write an element and its loads, or refuse it at the item of its property set."""
    kind = card.spec.name
    if kind not in ELEMENTS:
        script.refuse(f"the element {kind} ({card.label})", card.span)
        return
    try:
        ELEMENTS[kind](script, element, card)
        if kind == "FRAME":
            loads.member(script, element, card)
    except ItemError as refusal:
        script.refuse(f"{refusal} ({card.label})", card.place(refusal.item))


def default_step(script: Script, ready: Prepared, end: float) -> float:
    """Time step [T] that resolves contacts and samples of records, a round part of the latter."""
    bounds = [end / STEPS]
    for law in script.structure.laws:
        mass, k = law.facts.get("reduced_mass", 0.0), law.facts.get("k", 0.0)
        if mass and k:
            k *= 1.0 if law.facts["k_unit"] == "F/L" else math.sqrt(law.gap)
            bounds.append(math.pi * math.sqrt(mass / k) / PER_CONTACT)
    samples = [m.info["dt"] for m in ready.motions if m.info.get("dt")]
    if not samples:
        return _round_down(min(bounds))
    sample = min(samples)
    parts = max(PER_SAMPLE, math.ceil(sample / min(bounds)))
    return float(sample) / _round_up(parts)


def _round_down(x: float) -> float:
    """The largest of 1, 2 or 5 times a power of ten that is not above `x`."""
    power = math.floor(math.log10(x))
    head = max(h for h in (1, 2, 5) if h * 10.0**power <= x * (1.0 + 1e-9))
    return float(f"{head}e{power}")


def _round_up(n: int) -> int:
    """The smallest of 1, 2 or 5 times a power of ten that is not below `n`."""
    power = int(10 ** (len(str(n)) - 1))
    return min(h * power for h in (1, 2, 5, 10) if h * power >= n)


def _text(script: Script, compared: ComparedItems, end: float, step: float, deck: str) -> str:
    """Text of the script."""
    units = script.model.units
    title = script.model.title or deck
    weight = script.model.gravity * sum(abs(m).max() for _, _, m in script.structure.mass_blocks)
    opening = (
        f'"""{_plain(title)}\n\nScript for OpenSeesPy from the deck {_plain(deck)}, written by pound-solve '
        f"{__version__}.\nUnits {units.force} {units.length} {units.time}.  Stiffnesses of neighbours, "
        "dashpots and factors of damping that the\ndeck gives by a relation are numbers here; nothing is "
        'a result of another program.\n"""\n'
    )
    constants = {
        "END": literal(end),
        "STEP": literal(step),
        "TOLERANCE": f"{1e-10 * (weight or 1.0):.3g}",
        "CONSTRAINTS": literal("Transformation" if script.arms else "Plain"),
        "LOADED": repr(bool(script.structure.loads.any())),
        "SETTLED": repr(script.settled and not script.structure.released.any()),
        "FIRST_SWAY": literal(script.tag()),
        "SWAY": table(script.sway),
        "CONTACTS": table(f"({literal(n)}, {e})" for n, e in compared.contacts.items()),
        "DRIFTS": table(f"({literal(n)}, {i}, {j}, {d})" for n, (i, j, d) in compared.drifts.items()),
        "DISPLACEMENTS": table(f"({literal(n)}, {i}, {d})" for n, (i, d) in compared.displacements.items()),
    }
    notes = {
        "END": "of the history",
        "TOLERANCE": "unbalanced force",
        "SWAY": "member, nodes, length, direction: an axial force N times the sway over the length pushes",
    }
    texts = [f"{n} = {x}" if n not in notes else f"#: {notes[n]}\n{n} = {x}" for n, x in constants.items()]
    functions = [_function(name, script.lines[name]) for name in SECTIONS]
    model = "\n\n\n".join(functions)
    return "\n".join([opening.rstrip(), template.HEAD, *texts, "\n", model, "", template.RUN])


def _function(name: str, statements: list[str]) -> str:
    """Text of a function."""
    body = [f'"""{SECTIONS[name]}"""', *statements]
    return f"def {name}():\n" + textwrap.indent("\n".join(body), "    ")


def _plain(text: str) -> str:
    """A text without what would end a docstring."""
    return text.replace("\\", "/").replace('"""', "'''")
