"""Loads and analyses: what holds, what pushes, what shakes.

A script loads a frame in a static analysis, holds the loads with ``loadConst``, and then pushes a node or
lets time pass.  Here the first part is STATIC with the loads held; the others are PUSHOVER and HISTORY,
which start from that state.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from pound_import.draft import Draft, number, numbers
from pound_import.opensees.commands import Command, options
from pound_import.opensees.model import AnalyzeCall, ScriptModel, ScriptPattern
from pound_import.opensees.motions import Motions, table, wave
from pound_import.opensees.new_deck import NewDeck, ends
from pound_import.opensees.series import TimeSeries, series
from pound_import.opensees.timeline import TRANSIENT

Calls = list[AnalyzeCall]  #: in their order
_AXES = "XY"


@dataclass(slots=True)
class Stages:
    """Translator of loads and analyses.

    Attributes
    ----------
    model : ScriptModel
    deck : NewDeck
    draft : Draft
    motions : Motions
    """

    model: ScriptModel
    deck: NewDeck
    draft: Draft
    motions: Motions
    _loads: bool = field(default=False, init=False)

    def write(self) -> None:
        """Write loads, motions and analyses; mistakes go to the draft's report."""
        static, pushes, shaken = _sorted(self.model.stages)
        pushing = {tag for stage in pushes for tag in stage.patterns}
        for tag, pattern in self.model.patterns.items():
            with self.draft.keeping():
                self._pattern(tag, pattern, static, tag in pushing, bool(shaken))
        self._analyses(static, pushes, shaken)

    # ------------------------------------------------------------------ loads

    def _pattern(self, tag: int, pattern: ScriptPattern, static: Calls, pushes: bool, shakes: bool) -> None:
        command = pattern.command
        kind = command.word(1, "its type")
        if kind == "UniformExcitation":
            self.motions.write(command)
            return
        if kind != "Plain":
            raise command.mistake(
                f"pattern {kind[:40]} has no counterpart", "use Plain or UniformExcitation"
            )
        options(command, 3).only(("-fact", "-factor"))
        acting, scale = self._series(command)
        if acting.kind in ("Path", "Trig"):
            self._forces(pattern, acting, scale)
        elif pushes and pattern.factor is None:
            return  # `_pushover` writes it
        else:
            self._static(pattern, scale * self._held(tag, pattern, acting, static, shakes))

    def _series(self, command: Command) -> tuple[TimeSeries, float]:
        """Series of a pattern Plain, and the factor on it."""
        choice = options(command, 3)
        acting = series(self.model, " ".join(choice.plain), command)
        return acting, choice.real("-fact", choice.real("-factor", 1.0))

    def _held(
        self, tag: int, pattern: ScriptPattern, acting: TimeSeries, static: Calls, shakes: bool
    ) -> float:
        """Value of the series of a static pattern."""
        if pattern.factor is not None:
            return acting.value(pattern.factor)
        loading = [stage for stage in static if tag in stage.patterns]
        if not loading:
            return acting.value(1.0)
        if shakes and acting.kind == "Linear":
            self.draft.lose(
                pattern.command.span,
                f"the growth of pattern {tag} in the transient analysis; no loadConst holds it",
                "check whether loadConst -time 0.0 is missing after the static analysis",
            )
        return acting.value(loading[-1].end)

    def _static(self, pattern: ScriptPattern, factor: float) -> None:
        released = " HELD=NO" if pattern.removed else ""
        for load in pattern.loads:
            with self.draft.keeping():
                if load.name == "load":
                    node, values = self._nodal(load)
                    if any(values) and factor:
                        words = " ".join(number(factor * value) for value in values)
                        self.draft.add("LOADS", f"{self.deck.node(node)} {words}{released}", load.span)
                        self._loads = True
                elif load.name == "eleLoad":
                    self._member(load, factor)
                    if released:
                        raise load.mistake("a load of members that is removed", "load the nodes instead")
                else:
                    raise load.mistake(f"{load.name} in a pattern has no counterpart", "apply forces")

    def _nodal(self, load: Command) -> tuple[int, list[float]]:
        """Node and force of a `load`."""
        node = load.whole(1, "the node")
        self.model.point(node, load)
        values = [0.0, 0.0, 0.0]
        plain = [word for word in load.words if word != "-const"]
        if len(plain) != 2 + len(self.model.letters):
            what = f"load {node}: {len(plain) - 2} values, not {len(self.model.letters)}"
            raise load.mistake(what, "OpenSees leaves such a load out", "L620")
        for k, letter in enumerate(self.model.letters):
            values["XYR".index(letter)] = load.real(2 + k, "a force")
        return node, values

    def _member(self, load: Command, factor: float) -> None:
        """Write the loads of members, in their local axes there and in global ones here."""
        choice = options(load, 1)
        choice.only(("-ele", "-range", "-type", "-beamUniform", "-beamPoint"))
        tags = choice.wholes("-ele")
        limits = choice.wholes("-range")
        if len(limits) == 2:
            tags += [tag for tag in self.model.elements if limits[0] <= tag <= limits[1]]
        uniform, point = choice.reals("-beamUniform"), choice.reals("-beamPoint")
        if not tags or bool(uniform) == bool(point) or len(uniform) > 2 or len(point) not in (0, 2, 3):
            what = "eleLoad: -ele or -range, and -beamUniform Wy Wx or -beamPoint Py x/L Px are read"
            raise load.mistake(what)
        across, along = (*uniform, 0.0)[:2] if uniform else (point[0], (*point, 0.0)[2])
        for tag in tags:
            element = self.model.item("the element", self.model.elements, tag, load)
            if tag not in self.deck.written:
                continue  # the element itself is a mistake
            if tag not in self.deck.members:
                raise load.mistake(f"eleLoad on element {tag}, which is no beam", "load its nodes")
            i, j = (self.model.points[end] for end in ends(element, self.model))
            length = ((j.x - i.x) ** 2 + (j.y - i.y) ** 2) ** 0.5 or 1.0
            cos, sin = (j.x - i.x) / length, (j.y - i.y) / length
            x, y = factor * (cos * along - sin * across), factor * (sin * along + cos * across)
            where = f" AT={number(point[1])}" if point else ""
            kind = "P" if point else "W"
            words = "".join(f" {kind}{d}={number(value)}" for d, value in (("X", x), ("Y", y)) if value)
            if words:
                self.draft.add("MEMBER_LOADS", f"{self.deck.written[tag][0]}{words}{where}", load.span)
                self._loads = True

    def _forces(self, pattern: ScriptPattern, acting: TimeSeries, scale: float) -> None:
        """Write forces that vary with time."""
        of_file = bool(acting.path()) and acting.path() not in self.motions.written
        tabled = acting.kind == "Path" and not of_file  # the values of a table have the series' factor
        factor = scale if tabled else scale * acting.factor
        for load in pattern.loads:
            if load.name != "load":
                raise load.mistake(f"{load.name} that varies with time has no counterpart")
            node, values = self._nodal(load)
            direction = " ".join(
                f"{item}={number(factor * value)}"
                for item, value in zip(("FX", "FY", "MZ"), values)
                if value
            )
            if not direction:
                continue
            head = f"{self.deck.node(node)} {direction}"
            if acting.kind == "Trig":
                words = f"SINE {head} {wave(acting)}"
            elif of_file:
                file, layout = self.motions.record(acting)
                words = f"RECORD {head} FILE={file} {layout}"
            else:
                kind, points = table(self.motions.points(acting), 1.0).split(" ")
                words = f"{kind} {head} {points}"
            self.draft.add("FORCES", words, load.span)

    # ------------------------------------------------------------------ analyses

    def _analyses(self, static: Calls, pushes: Calls, shaken: Calls) -> None:
        for count, command in self.model.modes[:1]:
            self.draft.add("ANALYSIS", f"MODAL {count}", command.span)
        first = next(iter((*static, *pushes, *shaken)), None)
        if self._loads or static or not (pushes or shaken or self.model.modes):
            place = first.command.span if first else next(iter(self.model.elements.values())).span
            self.draft.add("ANALYSIS", "STATIC SELF_WEIGHT=NO", place)
        if pushes:
            with self.draft.keeping():
                self._pushover(pushes)
        if pushes and shaken:
            self.draft.lose(
                shaken[0].command.span, "the push before the history, which starts from the static state"
            )
        if shaken:
            duration = shaken[-1].end - shaken[0].start
            if duration > 0.0:
                self.draft.add("ANALYSIS", f"HISTORY {duration:.12g}", shaken[0].command.span)
            else:
                what = "a transient analysis without a time step"
                shaken[0].command.mistake(what, code="L620").keep(self.draft.report)

    def _pushover(self, pushes: Calls) -> None:
        """Write a push of one node by the loads that grow."""
        command = pushes[0].command
        controlled = {stage.integrator[1:3] for stage in pushes}
        if len(controlled) > 1:
            raise command.mistake("a push that changes the node or direction it controls")
        words = Command(("DisplacementControl", *pushes[0].integrator[1:]), command.span)
        node, direction = words.whole(1, "the node"), words.whole(2, "the direction")
        self.model.point(node, words)
        if direction not in (1, 2):
            raise command.mistake("a push that controls a rotation has no counterpart")
        axis = _AXES[direction - 1]
        forces: dict[int, float] = {}
        for value, load in self._growing(pushes):
            tag, values = self._nodal(load)
            if any(x for k, x in enumerate(values) if k != direction - 1):
                raise load.mistake(
                    f"a push with forces across {axis}", "loads that do not grow belong before loadConst"
                )
            forces[tag] = forces.get(tag, 0.0) + value * values[direction - 1]
        forces = {tag: force for tag, force in forces.items() if force}
        if not forces:
            raise command.mistake("a push without loads that grow")
        targets = _turns([stage.moved for stage in pushes])
        self.draft.add(
            "ANALYSIS",
            f"PUSHOVER {self.deck.node(node)} {numbers(targets)} DIRECTION={axis} PATTERN=FORCES "
            f"NODES={self.deck.nodes(forces)} FORCES={numbers(forces.values())}",
            command.span,
            ["TARGET counts from zero load, the push of the model from the state under its loads"]
            if self._loads
            else [],
        )

    def _growing(self, pushes: Calls) -> Iterator[tuple[float, Command]]:
        """Loads that grow in a push, with their factors."""
        for tag in dict.fromkeys(tag for stage in pushes for tag in stage.patterns):
            pattern = self.model.patterns[tag]
            if pattern.factor is not None or pattern.command.words[1] != "Plain":
                continue
            acting, scale = self._series(pattern.command)
            for load in pattern.loads:
                if load.name != "load":
                    raise load.mistake(
                        f"{load.name} that grows in a push has no counterpart", "load the nodes"
                    )
                yield scale * acting.factor, load


def _turns(steps: Iterable[float]) -> list[float]:
    """Displacements at which a sequence of steps turns, and the last."""
    targets: list[float] = []
    at = before = 0.0
    for step in steps:
        at = float(f"{at + step:.12g}")
        if targets and step * before >= 0.0:
            targets[-1] = at
        else:
            targets.append(at)
        before = step or before
    return targets


def _sorted(stages: Calls) -> tuple[Calls, Calls, Calls]:
    """Static stages, pushes under displacement control, and those in time."""
    static = [s for s in stages if s.kind != TRANSIENT and s.integrator[0] != "DisplacementControl"]
    pushes = [s for s in stages if s.kind != TRANSIENT and s.integrator[0] == "DisplacementControl"]
    return static, pushes, [s for s in stages if s.kind == TRANSIENT]
