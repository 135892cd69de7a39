"""From the commands of a model of OpenSees to a deck of this program."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import PurePath
from typing import Final

from pound_deck.diagnostics import Diagnostic, has_errors
from pound_deck.model import Span
from pound_import.draft import Draft, quoted
from pound_import.opensees.beams import Beams
from pound_import.opensees.commands import Command, options
from pound_import.opensees.constraints import followers
from pound_import.opensees.damping import Factors
from pound_import.opensees.links import Links
from pound_import.opensees.materials import Materials
from pound_import.opensees.model import ScriptModel, sorted_models
from pound_import.opensees.motions import Motions
from pound_import.opensees.new_deck import NewDeck
from pound_import.opensees.replay import Replayed
from pound_import.opensees.sections import FIBRES, Sections
from pound_import.opensees.stages import Stages
from pound_import.translation import Translation, written

#: finds the axial forces of a deck's elements in its static state, tension positive [F]
Axial = Callable[[str], Mapping[int, float]]
_CHECK: Final = "compare periods and displacements with those of OpenSees"
_NO_UNITS: Final = (
    "the model states no units: forces, lengths and times are kept, and gravity is 1 so that weights are "
    "masses; import --units force,length,time names the units and sets gravity"
)


def translate(
    name: str,
    replayed: Replayed,
    axial: Axial,
    units: Sequence[str] = (),
    shown: Callable[[str], str] = lambda file: file,
) -> Translation:
    """Make a deck of a model.

    Parameters
    ----------
    name : str
        Of its file.
    replayed : Replayed
    axial : Axial
        Finds the axial forces of a deck's elements in its static state.
    units : sequence of str
        Names of its units of force, length and time; none: they are not known.
    shown : function
        Name of a file beside the model as the new deck names it.

    Returns
    -------
    Translation
    """
    draft = Draft(_CHECK)
    if replayed.mistake:
        draft.report.append(replayed.mistake)
    model = _chosen(sorted_models(replayed.commands, draft), name, draft)
    if model is not None:
        cut = (
            replayed.mistake is not None and replayed.mistake.severity == "error"
        )  # loads are not complete
        forces = None if cut else _forces(model, replayed, axial)
        _write(model, replayed, units, shown, draft, forces)
    draft.report[:] = dict.fromkeys(draft.report)
    draft.report.sort(key=lambda d: (d.span.file, d.span.line) if d.span else ("", 0))
    if has_errors(draft.report):
        return Translation("", (), tuple(draft.report))
    title = PurePath(name).name
    return written(title, f"Read from the OpenSees model {title}.", draft)


def _forces(model: ScriptModel, replayed: Replayed, axial: Axial) -> dict[int, float]:
    """Axial forces of elements in the static state with elastic sections, where some are of fibres."""
    if not any(section.words[1] in FIBRES for section in model.sections.values()):
        return {}
    trial = Draft(_CHECK)
    deck = _write(model, replayed, (), lambda file: file, trial, None)
    if has_errors(trial.report):
        return {}  # the report will say so
    forces = axial(written("", "", trial).text)
    return {tag: forces.get(numbers[0], 0.0) for tag, numbers in deck.written.items()}


def so_far(name: str, commands: Sequence[Command]) -> tuple[str, dict[int, int]]:
    """Deck of the state that the commands so far define, to find modes, and its nodes' numbers by tags."""
    draft = Draft(_CHECK)
    model = sorted_models(commands, draft)[-1]
    if not model.elements:
        return "", {}
    model.modes, model.damping = [(1, commands[-1])], []
    if not model.stages:  # at rest
        model.patterns = {}
    deck = _write(model, Replayed(), (), lambda file: file, draft, None)
    return written(name, "", draft).text, {tag: deck.node(tag) for tag in model.points}


def _chosen(models: Sequence[ScriptModel], name: str, draft: Draft) -> ScriptModel | None:
    """First model that is analysed, else the last that has elements."""
    built = [model for model in models if model.elements]
    if not built:
        here = Span(name, 1, 1, 2)
        hint = "name the file that builds the model, and sources the others"
        if not has_errors(draft.report):  # else these say why
            draft.report.append(Diagnostic("L624", f"{name} builds no elements", here, hint))
        return None
    chosen = next((model for model in built if model.complete), built[-1])
    for model in built:
        if model is not chosen:
            command = next(iter(model.elements.values()))
            draft.lose(
                command.span,
                "another model of the same script (wipe)",
                "import it from a script of its own",
            )
    return chosen


def _write(
    model: ScriptModel,
    replayed: Replayed,
    units: Sequence[str],
    shown: Callable[[str], str],
    draft: Draft,
    forces: Mapping[int, float] | None,
) -> NewDeck:
    """Fill the draft; return the new deck's numbers."""
    here = (
        next(iter(model.points.values())).command.span
        if model.points
        else next(iter(model.elements.values())).span
    )
    draft.add("", f"UNITS {' '.join(units or ('F', 'L', 'T'))}", here, () if units else [_NO_UNITS])
    draft.add("", f"PARAM g={_gravity(units)}", here)
    draft.add("", "GRAVITY g", here)
    factors = Factors(model, draft)
    deck = NewDeck(model, draft, factors.stiffnesses)
    geometries: dict[str, Command] = {}
    _elements(model, deck, draft, geometries, forces)
    _shaken_twice(model, draft)
    _geometry(geometries, draft)
    deck.write_nodes(followers(model, draft))
    _drifts(model, deck, draft)
    _velocities(model, deck, draft)
    factors.write(deck)
    Stages(model, deck, draft, Motions(model, draft, replayed, shown)).write()
    return deck


def _elements(
    model: ScriptModel,
    deck: NewDeck,
    draft: Draft,
    geometries: dict[str, Command],
    forces: Mapping[int, float] | None,
) -> None:
    """Write elements and their property sets."""
    materials = Materials(model, draft)
    sections = Sections(model, materials)
    beams = Beams(model, deck, materials, sections, geometries, forces)
    links = Links(model, deck, materials, sections)
    kinds: Mapping[str, Callable[[int, Command], None]] = {
        "elasticBeamColumn": beams.elastic,
        "ElasticTimoshenkoBeam": beams.timoshenko,
        **dict.fromkeys(("truss", "Truss", "corotTruss", "CorotTruss"), beams.bar),
        **dict.fromkeys(("forceBeamColumn", "nonlinearBeamColumn", "dispBeamColumn"), beams.integrated),
        "beamWithHinges": beams.with_hinges,
        "zeroLength": links.zero_length,
        "zeroLengthSection": links.of_section,
        "twoNodeLink": links.two_nodes,
    }
    for tag, command in model.elements.items():
        with draft.keeping():
            kind = command.word(1, "its type")
            if kind not in kinds:
                hint = "elements that are read: " + ", ".join(sorted(kinds))
                raise command.no_counterpart(kind, kinds, hint)
            kinds[kind](tag, command)


def _shaken_twice(model: ScriptModel, draft: Draft) -> None:
    """Warn of masses that OpenSees 3.7.1 shakes otherwise: tried on a cantilever, elasticBeamColumn."""
    heavy = next((c for c in model.elements.values() if "-mass" in c.words), None)
    if heavy and any(p.command.words[1] == "UniformExcitation" for p in model.patterns.values()):
        reading = (
            "the ground shakes masses of elements (-mass) once; OpenSees 3.7.1 applies this force twice"
        )
        draft.doubt(heavy.span, reading)


def _geometry(geometries: Mapping[str, Command], draft: Draft) -> None:
    """Write the card of the geometry: that of the members which need most."""
    for name in ("LARGE", "PDELTA_VARYING"):
        if name in geometries:
            place = geometries[name].span
            notes = []
            if len(geometries) > 1:
                other = next(kind for kind in ("SMALL", "PDELTA_VARYING") if kind in geometries)
                first = geometries[other]
                reading = (
                    f"GEOMETRY {name} also for {first.words[1]} {first.words[2]} and others of {other}"
                )
                notes = [draft.doubt(first.span, reading)]
            draft.add("", f"GEOMETRY {name}", place, notes)
            return


def _gravity(units: Sequence[str]) -> str:
    """Acceleration of gravity in the units."""
    return _GRAVITIES.get(units[1].lower(), "1") if units else "1"


#: as the deck's own units give them
_GRAVITIES: Final = {"m": "9.81", "mm": "9810", "cm": "981", "ft": "32.174", "in": "386.09"}


def _drifts(model: ScriptModel, deck: NewDeck, draft: Draft) -> None:
    """Write the drifts that the model records."""
    for command in model.drifts:
        with draft.keeping():
            choice = options(command, 2)
            lower, upper = choice.wholes("-iNode"), choice.wholes("-jNode")
            axis = {1: "X", 2: "Y"}.get((*choice.wholes("-dof"), 1)[0])
            if axis is None:
                continue
            for i, j in zip(lower, upper):
                model.point(i, command)
                model.point(j, command)
                direction = "" if axis == "X" else " DIRECTION=Y"
                name = quoted(f"{i}-{j}" + ("" if axis == "X" else " Y"))
                line = f"{name} {deck.node(i)} {deck.node(j)}{direction}"
                if all(old.text != line for old in draft.sections["DRIFT"]):
                    draft.add("DRIFT", line, command.span)


def _velocities(model: ScriptModel, deck: NewDeck, draft: Draft) -> None:
    """Write velocities at the start."""
    for command in model.velocities:
        with draft.keeping():
            node, direction = command.whole(1, "the node"), command.whole(2, "the direction")
            model.point(node, command)
            value = command.real(3, "the velocity")
            if direction not in (1, 2, 3):
                raise command.mistake(
                    f"setNodeVel: direction {direction} lies outside of the plane", code="L620"
                )
            draft.add("INITIAL", f"{deck.node(node)} V{'XYR'[direction - 1]}={value!r}", command.span)
