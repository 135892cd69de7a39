"""Nodes that follow others: equalDOF and rigidLink.

Each command ties directions of a node to those of another.  A node may follow several others, and a node
that is followed may follow a third: each direction is traced to the node at the end of its chain, which
becomes its master.  The new deck gives every follower a rigid arm from its master, so a node that moves
otherwise is refused: for example one beside the axis through a node that turns, which equalDOF ties to it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from pound_import.draft import Draft
from pound_import.opensees.commands import Command
from pound_import.opensees.model import DIRECTIONS, ScriptModel

#: masters of a node's directions, by their letters
Followers = dict[int, dict[str, int]]
_Freedom = tuple[int, str]  #: a node and a letter of its directions
_ALIKE: Final = 1e-9  #: difference of two arms that is rounding, as a fraction of their lengths


@dataclass(frozen=True, slots=True)
class Tie:
    """A direction of a node that follows the same direction of another, with a rigid arm or without."""

    master: int
    arm: bool
    command: Command


def followers(model: ScriptModel, draft: Draft) -> Followers:
    """Nodes that follow others, chains resolved; mistakes go to the draft's report."""
    ties: dict[_Freedom, Tie] = {}
    for command in model.ties:
        with draft.keeping():
            _take(command, model, ties)
    ends: Followers = {}
    for slave in dict.fromkeys(node for node, _ in ties):
        with draft.keeping():
            letters = [letter for letter in DIRECTIONS if (slave, letter) in ties]
            ends[slave] = {letter: _master(slave, letter, model, ties) for letter in letters}
    return ends


def _take(command: Command, model: ScriptModel, ties: dict[_Freedom, Tie]) -> None:
    """Add the ties of a command.

    Raises
    ------
    Mistake
        It is incomplete, names an unknown node, ties a node to itself, or a direction that is tied already.
    """
    arm = False
    if command.name == "rigidLink":
        arm = command.word(1, "bar or beam") in ("beam", "-beam")
        master, slave = command.whole(2, "the first node"), command.whole(3, "the second node")
        letters = "XYR" if arm else "XY"
    else:
        master, slave = command.whole(1, "the first node"), command.whole(2, "the second node")
        directions = [command.whole(k, "a direction") for k in range(3, len(command.words))]
        if not directions or not all(1 <= d <= len(model.letters) for d in directions):
            raise command.mistake(
                f"equalDOF {master} {slave}: a direction is missing or unknown", code="L620"
            )
        letters = "".join(DIRECTIONS[d - 1] for d in directions)
    model.point(master, command)
    model.point(slave, command)
    if master == slave:
        raise command.mistake(f"node {slave} follows itself", code="L620")
    for letter in letters:
        first = ties.setdefault((slave, letter), Tie(master, arm, command)).master
        if first != master:
            what = f"node {slave} follows two nodes in {letter}: {first} and {master}"
            hint = "here each direction follows one node: let one of the two follow the other"
            raise command.mistake(what, hint)


def _master(slave: int, letter: str, model: ScriptModel, ties: Mapping[_Freedom, Tie]) -> int:
    """Node at the end of the chain that a direction of a node follows.

    Raises
    ------
    Mistake
        The chain has no end, or the node does not move as at the end of a rigid arm from there.
    """
    command, chain = ties[slave, letter].command, _chain(slave, letter, ties)
    end = chain[-1]
    arms = [
        (master, _arm(node, master, letter, model))
        for node, master in pairwise(chain)
        if ties[node, letter].arm
    ]
    arms.append((end, -_arm(slave, end, letter, model)))  # that of the new deck
    turned: dict[int, float] = {}  # sum of the arms that one rotation turns
    for node, arm in arms:
        pivot = _chain(node, "R", ties)[-1]
        if "R" in model.points[pivot].letters and "R" not in model.points[pivot].fixed:
            turned[pivot] = turned.get(pivot, 0.0) + arm
    if any(abs(arm) > _ALIKE * max(abs(a) for _, a in arms) for arm in turned.values()):
        through = f" (through node {chain[1]})" if len(chain) > 2 else ""
        what = (
            f"{command.name} {end} {slave}{through}: node {slave} lies beside the axis through node {end}"
        )
        hint = "here a node follows a turning one by a rigid arm: use rigidLink beam, or nodes on one level"
        raise command.mistake(what, hint)
    return end


def _chain(node: int, letter: str, ties: Mapping[_Freedom, Tie]) -> list[int]:
    """Nodes that follow one another in a direction, from the first to the last master.

    Raises
    ------
    Mistake
        They follow one another in a circle.
    """
    chain = [node]
    while tie := ties.get((chain[-1], letter)):
        if tie.master in chain:
            what = f"node {tie.master} follows itself through others"
            raise tie.command.mistake(what, "leave one of these constraints out", "L620")
        chain.append(tie.master)
    return chain


def _arm(slave: int, master: int, letter: str, model: ScriptModel) -> float:
    """Displacement of a node for a unit rotation of its master [L]."""
    a, b = model.points[slave], model.points[master]
    return {"X": b.y - a.y, "Y": a.x - b.x, "R": 0.0}[letter]
