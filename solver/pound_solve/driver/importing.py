"""From the file of another program's model to a deck of this program."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from pound_deck.diagnostics import Diagnostic
from pound_deck.files import contents
from pound_deck.model import Span
from pound_deck.reader import read_text
from pound_import.translation import Translation
from pound_solve.catalog import catalog
from pound_solve.driver.reading import OF_OTHERS, ruaumoko

if TYPE_CHECKING:
    from pound_import.opensees.commands import Command
    from pound_import.opensees.replay import NaturalModes
    from pound_import.ruaumoko.equake import File
    from pound_solve.structure.structure import Structure

_EXECUTED: Final = (
    "a model in Python is read by executing it, with a module that stands in for OpenSees: whatever else "
    "the file does is done, too"
)


@dataclass(frozen=True)
class Choices:
    """What the user states beside the file.

    Attributes
    ----------
    records : sequence of File
        Of a deck of Ruaumoko whose record does not follow in it.
    shown : function
        Name of a file as the new deck names it.
    execute : bool
        A model in Python may be executed.
    units : tuple of str
        Of a model of OpenSees: force, length, time; none: not known.
    plane, load : str
        Of a model of SAP2000: the plane that is read, and its static loads; empty: the only ones.
    """

    records: Sequence[File] = ()
    shown: Callable[[Path], str] = Path.as_posix
    execute: bool = False
    units: tuple[str, ...] = ()
    plane: str = ""
    load: str = ""


def imported(name: str, choices: Choices) -> tuple[dict[str, str], Translation]:
    """Return the texts of the files read, by the names in messages, and the new deck.

    Raises
    ------
    OSError
        A file cannot be read.
    """
    suffix = Path(name).suffix.lower()
    match OF_OTHERS.get(suffix):
        case "OpenSees":
            return _opensees(name, suffix, choices)
        case "SAP2000":
            return _sap2000(name, choices)
    text, translation = ruaumoko(name, choices.records, choices.shown(Path(name)))
    others = {d.span.file for d in translation.report if d.span} - {name}
    return {name: text} | {file: _text(file) for file in sorted(others)}, translation


def _opensees(name: str, suffix: str, choices: Choices) -> tuple[dict[str, str], Translation]:
    """Replay a model of OpenSees and translate it."""
    from pound_import.opensees.importer import translate
    from pound_import.opensees.replay import replay

    contents(name)  # raises where the file cannot be read
    path = Path(name)
    if suffix == ".py" and not choices.execute:
        refusal = Diagnostic("L625", _EXECUTED, Span(name, 1, 1, 2), "read the file, then add --execute")
        return {}, Translation("", (), (refusal,))
    module = "tcl_model" if suffix == ".tcl" else "python_model"
    replayed = replay(path, name, module, lambda commands, count: _modes(name, commands, count))
    translation = translate(
        name,
        replayed,
        lambda text: _axial(name, text),
        choices.units,
        lambda file: choices.shown(path.parent / file),
    )
    files = {d.span.file for d in translation.report if d.span}
    return {file: _text(file) for file in sorted(files)}, translation


def _sap2000(name: str, choices: Choices) -> tuple[dict[str, str], Translation]:
    """Translate a model of SAP2000."""
    from pound_import.sap2000.importer import translate

    text = contents(name).decode("utf-8-sig", "replace").replace("\r\n", "\n")
    return {name: text}, translate(name, text, catalog(), choices.plane, choices.load)


def _text(name: str) -> str:
    """Text of a file for the lines that a message shows, empty where it cannot be read."""
    try:
        return contents(name).decode("utf-8", "replace")
    except OSError:
        return ""


def _modes(name: str, commands: Sequence[Command], count: int) -> NaturalModes:
    """Modes of a model of OpenSees as far as its commands define it; none where it has mistakes."""
    from numpy.linalg import LinAlgError

    from pound_import.opensees.importer import so_far
    from pound_import.opensees.replay import NaturalModes
    from pound_solve.analyses.static import solve
    from pound_solve.analyses.tangent_solution import InstabilityError
    from pound_solve.driver.prepare import DeckError

    text, numbers = so_far(name, commands)
    try:
        structure = _structure(name, text)
        if structure.model.geometry != "SMALL":  # P-Delta of the loads that act when the model asks
            state = solve(structure)
            structure = structure.stressed(state.axial).displaced(state.u)
        modes = structure.vibration(count)
    except (DeckError, InstabilityError, LinAlgError):  # LinAlgError: a mechanism
        return NaturalModes()
    n = min(count, len(modes.omega))
    shapes = {
        tag: [
            [
                sum(f * float(modes.shapes[c, k]) for c, f in structure.dofs.terms[number, d])
                for d in range(3)
            ]
            for k in range(n)
        ]
        for tag, number in numbers.items()
    }
    return NaturalModes([float(w) ** 2 for w in modes.omega[:n]], shapes)


def _axial(name: str, text: str) -> dict[int, float]:
    """Axial forces of a deck's elements in its static state; none where it has no such state."""
    from pound_solve.analyses.static import solve
    from pound_solve.analyses.static_response import static_response
    from pound_solve.analyses.tangent_solution import InstabilityError
    from pound_solve.driver.prepare import DeckError

    try:
        structure = _structure(name, text)
        forces = static_response(structure, solve(structure)).forces
    except (DeckError, InstabilityError):
        return {}
    return {force.element: force.value for force in forces if force.quantity == "axial I"}


def _structure(name: str, text: str) -> Structure:
    """Structure of a deck without its motions; raises DeckError."""
    from pound_solve.driver.prepare import assembled, without_motions
    from pound_solve.driver.request import Request

    model, remarks, files = read_text(text, catalog(), {}, name)
    return assembled(Request(name), model and without_motions(model), remarks, files).structure
