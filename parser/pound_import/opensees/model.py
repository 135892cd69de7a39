"""Model that a sequence of commands defines, each item with the command that gave it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Final

from pound_import.draft import Draft
from pound_import.opensees.commands import Command, options, whole
from pound_import.opensees.names import LEFT_OUT, READ, REFUSED
from pound_import.opensees.timeline import Timeline

DIRECTIONS: Final = "XYR"
#: freedoms of a node in models of one and two dimensions
_FREEDOMS: Final[Mapping[tuple[int, int], str]] = {(1, 1): "X", (2, 1): "X", (2, 2): "XY", (2, 3): "XYR"}


@dataclass(slots=True)
class Point:
    """A node: coordinates [L], letters of its directions and of the fixed ones, mass in each."""

    command: Command
    x: float
    y: float
    letters: str
    fixed: str = ""
    mass: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])


@dataclass(slots=True)
class ScriptPattern:
    """A pattern of loads.

    Attributes
    ----------
    command : Command
    loads : list of Command
        Its loads on nodes and members.
    factor : float or None
        Factor that holds from a `loadConst` on; None while it follows its series.
    removed : bool
        Whether it was removed.
    """

    command: Command
    loads: list[Command] = field(default_factory=list)
    factor: float | None = None
    removed: bool = False


@dataclass(frozen=True, slots=True)
class AnalyzeCall:
    """An `analyze`.

    Attributes
    ----------
    command : Command
    kind : str
        STATIC or TRANSIENT of `timeline`.
    integrator : tuple of str
        Words of the integrator.
    start, end : float
        Times [T].
    moved : float
        Displacement that it adds at the node that it controls [L].
    patterns : tuple of int
        Tags of the patterns that follow their series in it.
    """

    command: Command
    kind: str
    integrator: tuple[str, ...]
    start: float
    end: float
    moved: float
    patterns: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Damping:
    """A command of damping, with the elements and nodes that there were."""

    command: Command
    elements: tuple[int, ...]
    nodes: tuple[int, ...]


@dataclass(slots=True)
class ScriptModel:
    """A model, its items by their tags."""

    letters: str = "XYR"
    dimension: int = 2
    points: dict[int, Point] = field(default_factory=dict)
    ties: list[Command] = field(default_factory=list)
    materials: dict[int, Command] = field(default_factory=dict)
    sections: dict[int, Command] = field(default_factory=dict)
    fibres: dict[int, list[Command]] = field(default_factory=dict)
    transformations: dict[int, Command] = field(default_factory=dict)
    integrations: dict[int, Command] = field(default_factory=dict)
    elements: dict[int, Command] = field(default_factory=dict)
    series: dict[int, Command] = field(default_factory=dict)
    patterns: dict[int, ScriptPattern] = field(default_factory=dict)
    damping: list[Damping] = field(default_factory=list)
    drifts: list[Command] = field(default_factory=list)
    velocities: list[Command] = field(default_factory=list)
    modes: list[tuple[int, Command]] = field(default_factory=list)
    stages: list[AnalyzeCall] = field(default_factory=list)

    @property
    def complete(self) -> bool:
        """Whether it has members and an analysis."""
        return bool(self.elements and (self.stages or self.modes))

    def item(self, kind: str, items: Mapping[int, Command], tag: int, command: Command) -> Command:
        """Item that a command names by its tag.

        Raises
        ------
        Mistake
            There is none.
        """
        if tag in items:
            return items[tag]
        raise command.mistake(
            f"{' '.join(command.words[:3])[:60]} names {kind} {tag}, which is not defined", code="L623"
        )

    def point(self, tag: int, command: Command) -> Point:
        """Node by its tag; raises as `item`."""
        if tag in self.points:
            return self.points[tag]
        raise command.mistake(
            f"{' '.join(command.words[:3])[:60]} names node {tag}, which is not defined", code="L623"
        )


def sorted_models(commands: Iterable[Command], draft: Draft) -> list[ScriptModel]:
    """Sort commands into models: each `wipe` begins one; mistakes go to the draft's report."""
    reader = _Script(draft)
    for command in commands:
        reader.take(command)
    return reader.models


class _Script:
    """Reader of commands in turn."""

    def __init__(self, draft: Draft) -> None:
        self._draft = draft
        self._timeline = Timeline()
        self._section = 0
        self._pattern = 0
        self._lost: set[str] = set()
        self.model = ScriptModel()
        self.models = [self.model]

    def take(self, command: Command) -> None:
        name = command.name
        before, moved = self._timeline.time, sum(self._timeline.moved.values())
        with self._draft.keeping():
            if name in _TAKEN:
                _TAKEN[name](self, command)
            elif name == "source":
                what = (
                    f"the file {command.word(1, 'its name')[:60]}, which is not in the folder of the model"
                )
                self._draft.lose(command.span, what, "put it there; what it defines may be missing below")
            elif name in LEFT_OUT:
                self._lose_once(name, command)
            elif name not in READ and not name.lower().startswith("display"):  # procedures that draw
                what = (
                    f"{name[:40]} has no counterpart in a plane frame of this program"
                    if name in REFUSED
                    else f"{name[:40]} is not a known command of OpenSees"
                )
                near = get_close_matches(name, READ, 1) if name not in REFUSED else []
                hint = f"did you mean {near[0]}?" if near else "delete the line, or what needs it"
                raise command.mistake(what, hint)
        self._timeline.take(command.words)
        if name == "analyze":
            self._analyzed(command, before, moved)

    def _lose_once(self, name: str, command: Command) -> None:
        """Warn of a kind of command that is left out, at its first place."""
        if name not in self._lost:
            self._lost.add(name)
            self._draft.lose(
                command.span, f"{name}, of an analysis of reliability", "see the verbs of sensitivity"
            )

    # ------------------------------------------------------------------ geometry

    def _wipe(self, command: Command) -> None:
        if self.model.points:
            self.model = ScriptModel()
            self.models.append(self.model)

    def _model(self, command: Command) -> None:
        choice = options(command, 1)
        dimension = int(choice.real("-ndm", 0.0))
        freedoms = int(choice.real("-ndf", {1: 1.0, 2: 3.0}.get(dimension, 6.0)))
        if (dimension, freedoms) not in _FREEDOMS:
            what = f"a model of {dimension} dimensions and {freedoms} degrees of freedom at a node"
            raise command.mistake(
                f"{what}; this program reads plane frames", "model one of its frames: -ndm 2 -ndf 3"
            )
        self.model.letters, self.model.dimension = _FREEDOMS[dimension, freedoms], dimension

    def _node(self, command: Command) -> None:
        tag = command.whole(1, "the tag")
        x = command.real(2, "x")
        y = command.real(3, "y") if self.model.dimension > 1 else 0.0
        choice = options(command, 2 + self.model.dimension)
        choice.only(("-mass", "-ndf"))
        _once(self.model.points, tag, command)
        self.model.points[tag] = Point(command, x, y, self.model.letters)
        self._set_mass(tag, choice.reals("-mass"))

    def _set_mass(self, tag: int, values: list[float]) -> None:
        mass = self.model.points[tag].mass = [0.0, 0.0, 0.0]
        for value, letter in zip(values, self.model.letters):
            mass[DIRECTIONS.index(letter)] = value

    def _mass(self, command: Command) -> None:
        tag = command.whole(1, "the node")
        self.model.point(tag, command)
        self._set_mass(tag, [command.real(k, "the mass") for k in range(2, len(command.words))])

    def _fix(self, command: Command) -> None:
        point = self.model.point(command.whole(1, "the node"), command)
        if len(command.words) < 2 + len(self.model.letters):
            count = len(command.words) - 2
            what = f"fix {command.words[1]}: {count} restraints, not {len(self.model.letters)}"
            raise command.mistake(what, "1 is fixed, 0 is free, in each direction", "L620")
        self._fix_point(point, command)

    def _fix_point(self, point: Point, command: Command) -> None:
        for letter, word in zip(self.model.letters, command.words[2:]):
            if whole(command, word, "a restraint") and letter not in point.fixed:
                point.fixed += letter

    def _fix_line(self, command: Command) -> None:
        """Restrain all nodes with one coordinate."""
        at = command.real(1, "the coordinate")
        tolerance = options(command, 2).real("-tol", 1e-10)
        for point in self.model.points.values():
            if abs((point.x if command.name == "fixX" else point.y) - at) <= tolerance:
                self._fix_point(point, command)

    def _tie(self, command: Command) -> None:
        self.model.ties.append(command)

    # ------------------------------------------------------------------ members

    def _section_begins(self, command: Command) -> None:
        self._section = command.whole(2, "the tag")
        _once(self.model.sections, self._section, command)
        self.model.sections[self._section] = command
        self.model.fibres[self._section] = []

    def _fibre(self, command: Command) -> None:
        self.model.fibres.setdefault(self._section, []).append(command)

    # ------------------------------------------------------------------ loads

    def _pattern_begins(self, command: Command) -> None:
        self._pattern = command.whole(2, "the tag")
        _once(self.model.patterns, self._pattern, command)
        self.model.patterns[self._pattern] = ScriptPattern(command)

    def _load(self, command: Command) -> None:
        if self._pattern not in self.model.patterns:
            raise command.mistake(f"{command.name} stands in no pattern", code="L623")
        self.model.patterns[self._pattern].loads.append(command)

    def _hold(self, command: Command) -> None:
        if self.model.stages:
            for pattern in self.model.patterns.values():
                if pattern.factor is None:
                    pattern.factor = self._timeline.time

    def _remove(self, command: Command) -> None:
        kind = command.word(1, "what to remove")
        if kind == "loadPattern":
            pattern = self.model.patterns.get(command.whole(2, "the pattern"))
            if pattern:
                pattern.removed = True
        elif kind not in ("recorder", "recorders", "timeSeries"):
            raise command.mistake(
                f"remove {kind[:40]}: a model that changes between analyses", "model the two apart"
            )

    # ------------------------------------------------------------------ analyses

    def _damp(self, command: Command) -> None:
        model = self.model
        self.model.damping.append(Damping(command, tuple(model.elements), tuple(model.points)))

    def _region(self, command: Command) -> None:
        if "-rayleigh" in command.words:
            self._damp(command)

    def _record(self, command: Command) -> None:
        if command.words[1:2] == ("Drift",):
            self.model.drifts.append(command)

    def _velocity(self, command: Command) -> None:
        self.model.velocities.append(command)

    def _eigen(self, command: Command) -> None:
        count = next((word for word in reversed(command.words) if word.isdigit()), "1")
        self.model.modes.append((int(count), command))

    def _analyzed(self, command: Command, before: float, moved: float) -> None:
        line, model = self._timeline, self.model
        following = tuple(t for t, p in model.patterns.items() if p.factor is None and not p.removed)
        pushed = sum(line.moved.values()) - moved
        model.stages.append(
            AnalyzeCall(command, line.kind, line.integrator, before, line.time, pushed, following)
        )

    def _refuse_displacement(self, command: Command) -> None:
        raise command.mistake(f"{command.name} sets a state", "start from the state under the loads")


def _once(items: Mapping[int, object], tag: int, command: Command) -> None:
    """Raise a Mistake if a tag is taken."""
    if tag in items:
        what = f"{' '.join(command.words[:3])[:60]}: the tag {tag} is defined twice"
        raise command.mistake(what, "OpenSees stops there, too: give one of them another tag", "L620")


def _kept(items: str) -> Callable[[_Script, Command], None]:
    """Return a function that keeps a command by its tag, the word behind its type."""

    def keep(reader: _Script, command: Command) -> None:
        tag = command.whole(2, "the tag")
        _once(getattr(reader.model, items), tag, command)
        getattr(reader.model, items)[tag] = command

    return keep


_TAKEN: Final[Mapping[str, Callable[[_Script, Command], None]]] = {
    "wipe": _Script._wipe,
    "model": _Script._model,
    "node": _Script._node,
    "mass": _Script._mass,
    "fix": _Script._fix,
    **dict.fromkeys(("fixX", "fixY"), _Script._fix_line),
    **dict.fromkeys(("equalDOF", "rigidLink"), _Script._tie),
    "uniaxialMaterial": _kept("materials"),
    "section": _Script._section_begins,
    **dict.fromkeys(("patch", "layer", "fiber"), _Script._fibre),
    "geomTransf": _kept("transformations"),
    "beamIntegration": _kept("integrations"),
    "element": _kept("elements"),
    "timeSeries": _kept("series"),
    "pattern": _Script._pattern_begins,
    **dict.fromkeys(("load", "eleLoad", "sp", "groundMotion", "imposedMotion"), _Script._load),
    "loadConst": _Script._hold,
    "remove": _Script._remove,
    **dict.fromkeys(("rayleigh", "modalDamping"), _Script._damp),
    "region": _Script._region,
    "recorder": _Script._record,
    "setNodeVel": _Script._velocity,
    "eigen": _Script._eigen,
    "setNodeDisp": _Script._refuse_displacement,
}
