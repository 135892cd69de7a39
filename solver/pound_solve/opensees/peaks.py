"""The quantities of which both programs keep the peaks, and our peaks from a results file."""

from __future__ import annotations

from typing import NamedTuple

from pound_deck.model import Model
from pound_solve.results import Results
from pound_solve.user_error import UserError

MOST_NODES = 12  #: nodes whose displacements are compared if a deck has neither contacts nor drifts


class ComparedItems(NamedTuple):
    """Items by name: contacts with their elements, drifts and displacements with nodes and direction.

    Attributes
    ----------
    contacts : dict of str to int
    drifts : dict of str to (int, int, int)
        Lower node, upper node, direction 1 or 2.
    displacements : dict of str to (int, int)
    """

    contacts: dict[str, int]
    drifts: dict[str, tuple[int, int, int]]
    displacements: dict[str, tuple[int, int]]


def compared_items(model: Model) -> ComparedItems:
    """Forces of contacts, drifts of DRIFT, and displacements along x of nodes at contacts.

    Raises
    ------
    UserError
        Two contacts have the same name.
    """
    touching = [e for e in model.elements.values() if model.props[e.prop].spec.name == "CONTACT"]
    contacts: dict[str, int] = {}
    for e in touching:
        name = e.name or str(e.id)
        if name in contacts:
            raise UserError(
                f"the contacts {contacts[name]} and {e.id} have one name, {name!r}: give one another"
            )
        contacts[name] = e.id
    drifts = {d.label: (d["I"], d["J"], "XY".index(d["DIRECTION"]) + 1) for d in model.drifts}
    nodes = [n for e in touching for n in (e.i, e.j) if n is not None]
    if not touching and not drifts:
        nodes = [n for card in model.weights for n in card["NODES"]][:MOST_NODES]
    moving = [n for n in dict.fromkeys(nodes) if "X" not in model.nodes[n].fixed]
    return ComparedItems(contacts, drifts, {f"node {n} X": (n, 1) for n in moving})


def our_peaks(results: Results, compared: ComparedItems) -> dict[str, float]:
    """Peaks of the same quantities by the names that the script prints; those that are not stored are left
    out.
    """
    peaks: dict[str, float] = {}
    for row in results.table("contact_summary"):
        if (name := word(row["contact"])) in compared.contacts:
            peaks[f"contact {name}, force"] = float(row["peak_force"])
    for row in results.table("drift_envelope"):
        name = word(row["name"])
        peaks |= {f"drift {name}, {end}": float(row[end]) for end in ("max", "min")}
    for row in results.table("node_envelope"):
        name = f"node {row['node']} {word(row['direction'])}"
        if word(row["quantity"]) == "displacement" and name in compared.displacements:
            peaks |= {f"{name}, {end}": float(row[end]) for end in ("max", "min")}
    return peaks


def word(cell: object) -> str:
    """Text of a cell, which the file may return as bytes."""
    return cell.decode() if isinstance(cell, bytes) else str(cell)
