"""Nodes that follow others: equalDOF and rigidLink."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from pound_deck.diagnostics import Mistake
from pound_import.draft import Draft
from pound_import.opensees.commands import Command
from pound_import.opensees.model import DIRECTIONS, ScriptModel

_ONE: Final = (
    "here a node follows one other: leave out the constraint of the floor, whose beams do the same but for "
    "their strain, or give members their hinges (beamWithHinges)"
)
#: letters of a node that follow another, and that node
Followers = dict[int, tuple[str, int]]


def followers(model: ScriptModel, draft: Draft) -> Followers:
    """Nodes that follow others, chains resolved; mistakes go to the draft's report.

    Returns
    -------
    Followers
    """
    tied: dict[int, tuple[str, int, Command]] = {}
    for command in model.ties:
        try:
            letters, master, slave = _tie(model, command)
            if slave in tied and tied[slave][1] != master:
                raise command.mistake(f"node {slave} follows two nodes", _ONE)
            known = tied[slave][0] if slave in tied else ""
            tied[slave] = known + "".join(d for d in letters if d not in known), master, command
        except Mistake as mistake:
            mistake.keep(draft.report)
    ends: Followers = {}
    for slave, (letters, master, command) in tied.items():
        try:
            ends[slave] = letters, _root(tied, slave, letters, master, command)
        except Mistake as mistake:
            mistake.keep(draft.report)
    return ends


def _tie(model: ScriptModel, command: Command) -> tuple[str, int, int]:
    """Letters that follow, the node followed and the one that follows."""
    if command.name == "rigidLink":
        kind = command.word(1, "bar or beam")
        master, slave = command.whole(2, "the first node"), command.whole(3, "the second node")
        letters = "XYR" if kind in ("beam", "-beam") else "XY"
    else:
        master, slave = command.whole(1, "the first node"), command.whole(2, "the second node")
        directions = [command.whole(k, "a direction") for k in range(3, len(command.words))]
        if not directions or not all(1 <= d <= len(model.letters) for d in directions):
            raise command.mistake(
                f"equalDOF {master} {slave}: a direction is missing or unknown", code="L620"
            )
        letters = "".join(DIRECTIONS[d - 1] for d in sorted(set(directions)))
    first, second = model.point(master, command), model.point(slave, command)
    if master == slave:
        raise command.mistake(f"node {slave} follows itself", code="L620")
    arms = {"X": first.y - second.y, "Y": second.x - first.x, "R": 0.0}
    turns = "R" not in first.fixed and len(model.letters) == 3
    beam = command.name == "rigidLink" and letters == "XYR"
    if turns and not beam and any(arms[d] for d in letters):
        what = f"{command.name} {master} {slave}: node {slave} lies beside the axis through node {master}"
        hint = "here a node follows a turning one by a rigid arm: use rigidLink beam, or nodes on one level"
        raise command.mistake(what, hint)
    return letters, master, slave


def _root(
    tied: Mapping[int, tuple[str, int, Command]], slave: int, letters: str, master: int, command: Command
) -> int:
    """Node at the end of a chain of nodes that follow each other."""
    passed = {slave}
    while master in tied and set(letters) & set(tied[master][0]):
        if master in passed:
            raise command.mistake(f"node {slave} follows itself through others", code="L620")
        if not set(letters) <= set(tied[master][0]):
            what = f"node {slave} follows node {master}, which follows another in some directions only"
            raise command.mistake(what, _ONE)
        passed.add(master)
        master = tied[master][1]
    return master
