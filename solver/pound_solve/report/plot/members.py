"""Choice of springs, contacts and members by the words of a user; M, V and N along members.

Between the ends of a member, moments and forces follow from those at its ends and the loads between them:
uniform loads (self weight among them) are what the end forces lack for equilibrium, point loads stand in
the table `member_loads`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot.beams import property_items
from pound_solve.report.plot.geometry import contact_name
from pound_solve.report.plot.schema import Choice, ChoiceError
from pound_solve.results import Results

STATIONS: Final = 21  #: places along a member
MOST_LISTED = 60  #: names in a message
#: forces along a member, with their names in words and those at both ends
QUANTITIES: Final[Mapping[str, tuple[str, str, str]]] = {
    "M": ("bending moment", "moment I", "moment J"),
    "V": ("shear force", "shear I", "shear J"),
    "N": ("axial force", "axial I", "axial J"),
}


def _words(results: Results, kind: str) -> list[set[str]]:
    """For each column of springs, contacts or members: the words that may name it, in lower case."""
    elements = results.table("elements")
    names = {int(e["element"]): str(e["name"]) for e in elements}
    if kind == "spring":
        labels = results.labels("spring/force") if "spring/force" in results.histories else ()
        numbers = [int(label.split()[0]) for label in labels]
    elif kind == "contact":
        labels = results.labels("contact/force") if "contact/force" in results.histories else ()
        number = {contact_name(e): int(e["element"]) for e in elements}
        numbers = [number.get(label, 0) for label in labels]
    else:
        numbers = members(results)
        labels = tuple(map(str, numbers))
    return [
        {word.lower() for word in (label, str(n), names.get(n, "")) if word}
        for label, n in zip(labels, numbers)
    ]


def members(results: Results) -> list[int]:
    """Numbers of the elements between two nodes that have axial forces at both ends."""
    two = {int(e["element"]) for e in results.table("elements") if e["j"]}
    return list(dict.fromkeys(e for e, quantity in _ends(results) if quantity == "axial I" and e in two))


def _ends(results: Results) -> list[tuple[int, str]]:
    """Element and quantity of every force of members, of the history or else of the static state."""
    if "member/force" in results.histories and len(results.time):
        attributes = results.attributes("member/force")
        return list(zip(map(int, attributes["element"]), map(str, attributes["quantity"])))
    if "static_force" in results.tables:
        return [(int(row["element"]), str(row["quantity"])) for row in results.table("static_force")]
    return []


def _columns(results: Results, choice: Choice, kind: str) -> list[int]:
    asked = {word.lower() for word in choice.member}
    return [k for k, words in enumerate(_words(results, kind)) if words & asked]


def refuse(results: Results, choice: Choice, kinds: Sequence[str]) -> None:
    """Raise where a word of `Choice.member` names nothing of these kinds (spring, contact, member).

    Raises
    ------
    ChoiceError
        It lists what there is.
    """
    known = {kind: _words(results, kind) for kind in kinds}
    for word in choice.member:
        if not any(word.lower() in words for names in known.values() for words in names):
            listed = "; ".join(f"{kind}s {_listed(results, kind)}" for kind in kinds if known[kind])
            raise ChoiceError(f"there is no {' or '.join(kinds)} {word!r}; there are: {listed or 'none'}")


def _listed(results: Results, kind: str) -> str:
    """Text of the names of all springs, contacts or members, the first of many."""
    if kind == "spring":
        names = list(results.labels("spring/force"))
    elif kind == "contact":
        names = list(results.labels("contact/force"))
    else:
        names = list(map(str, members(results)))
    more = f", ... ({len(names)})" if len(names) > MOST_LISTED else ""
    return ", ".join(names[:MOST_LISTED]) + more


def chosen_springs(results: Results, choice: Choice) -> list[int]:
    """Indices of the columns of the springs and hinges that the choice names."""
    return _columns(results, choice, "spring")


def chosen_contacts(results: Results, choice: Choice, refused: bool = True) -> list[int]:
    """Indices of the columns of the contacts that the choice names; empty where it names none.

    Raises
    ------
    ChoiceError
        It names something else, which is `refused`.
    """
    if refused:
        refuse(results, choice, ("contact",))
    return _columns(results, choice, "contact")


def chosen_members(results: Results, choice: Choice) -> list[int]:
    """Numbers of the members that the choice names, or of all.

    Raises
    ------
    ChoiceError
        It names something else.
    """
    refuse(results, choice, ("member",))
    numbers = members(results)
    return [numbers[k] for k in _columns(results, choice, "member")] or numbers


@dataclass(frozen=True, slots=True)
class MemberForces:
    """Forces along one member.

    Attributes
    ----------
    element : int
    i, j : ndarray, shape (2,)
        Ends of the flexible length [L].
    x : ndarray, shape (n,)
        Places between them, as fractions of that length.
    low, high : dict of str to ndarray, shape (n,)
        Smallest and largest ``M`` (positive where the member sags: tension on the right of the line from I
        to J) [F L], ``V`` (positive where it turns the member clockwise) and ``N`` (tension) [F].
    """

    element: int
    i: Array
    j: Array
    x: Array
    low: dict[str, Array]
    high: dict[str, Array]


def lines(
    results: Results, place: Mapping[int, Array], choice: Choice, row: Array | None = None
) -> Iterator[MemberForces]:
    """Forces along the chosen members, or all: of a `row` of the history, or their extremes over it
    (of the static state where there is none).

    The extremes at the ends are the true ones; between the ends they are those at the stored instants, and
    what these lack at the ends is added in proportion.
    """
    chosen = set(chosen_members(results, choice))
    if not chosen:
        return
    extremes: Mapping[tuple[int, str], tuple[float, float]] = {}
    if row is not None:
        values = dict(zip(_ends(results), row[:, None]))
    else:
        values, extremes = _values(results, choice), _extremes(results, choice)
    items, points = property_items(results), _point_loads(results)
    for e in results.table("elements"):
        number = int(e["element"])
        if number not in chosen:
            continue
        i, j = place[int(e["i"])], place[int(e["j"])]
        along = (j - i) / max(float(np.hypot(*(j - i))), 1e-300)
        section = items.get(str(e["property"]), {})
        first, last = float(section.get("END1", 0.0)), float(section.get("END2", 0.0))
        i, j = i + first * along, j - last * along
        at_ends = {quantity: v for (n, quantity), v in values.items() if n == number}
        x, forces = along_member(at_ends, float(np.hypot(*(j - i))), along, points.get(number, []))
        low = {q: v.min(axis=0) for q, v in forces.items()}
        high = {q: v.max(axis=0) for q, v in forces.items()}
        for q, (_, *ends) in ((q, QUANTITIES[q]) for q in forces):
            for end, name, sign, fraction in zip((0, -1), ends, _SIGN[q], (1.0 - x, x)):
                if (number, name) in extremes:
                    least, most = sorted(sign * v for v in extremes[number, name])
                    low[q] += fraction * (least - low[q][end])
                    high[q] += fraction * (most - high[q][end])
        yield MemberForces(number, i, j, x, low, high)


_SIGN: Final = {"M": (-1.0, 1.0), "V": (1.0, -1.0), "N": (1.0, 1.0)}  #: of the end forces at I and J


def along_member(
    ends: Mapping[str, Array], length: float, along: Array, points: Sequence[tuple[float, Array]] = ()
) -> tuple[Array, dict[str, Array]]:
    r"""Forces along a member from those at its ends.

    .. math:: M(x) = -M_I (1 - x/L) + M_J x/L + M_0(x), \quad V(x) = V_I + w x + \textstyle\sum P

    with :math:`M_0` the moment of the loads on a beam on two pins, and w the uniform load that the end
    forces leave beside the point loads.

    Parameters
    ----------
    ends : dict of str to ndarray, shape (nt,)
        ``moment I``, ``shear I``, ``axial I`` and those at J; a bar has the axial ones only.
    length : float
        Of the flexible part [L].
    along : ndarray, shape (2,)
        Direction from I to J.
    points : sequence of (place, force)
        Point loads: fraction of the length from I, and force along global x and y [F].

    Returns
    -------
    x : ndarray, shape (n,)
        Places as shares of the length: `STATIONS`, and both sides of each point load.
    forces : dict of str to ndarray, shape (nt, n)
        ``M``, ``V``, ``N`` as `MemberForces` defines them.
    """
    jumps = [a for a, _ in points for _ in range(2)]
    x = np.sort(np.concatenate([np.linspace(0.0, 1.0, STATIONS), jumps]))
    right = [np.arange(len(x)) > np.flatnonzero(x == a)[0] for a, _ in points]
    across = np.array([-along[1], along[0]])
    parts = [(a, float(p @ along), float(p @ across), beyond) for (a, p), beyond in zip(points, right)]
    forces = {}
    if "moment I" in ends:
        v, moment = ends["shear I"][:, None], (-ends["moment I"][:, None], ends["moment J"][:, None])
        w = -(v + ends["shear J"][:, None]) - sum(p for _, _, p, _ in parts)  # in all
        forces["M"] = moment[0] * (1.0 - x) + moment[1] * x - 0.5 * w * length * x * (1.0 - x)
        forces["V"] = v + w * x
        for a, _, p, beyond in parts:
            forces["M"] -= p * length * np.where(x < a, x * (1.0 - a), a * (1.0 - x))
            forces["V"] += p * beyond
    n = ends["axial I"][:, None]
    w = ends["axial J"][:, None] - n + sum(p for _, p, _, _ in parts)
    forces["N"] = n + w * x
    for _, p, _, beyond in parts:
        forces["N"] -= p * beyond
    return x, forces


def _values(results: Results, choice: Choice) -> dict[tuple[int, str], Array]:
    """End forces by element and quantity, shape (nt,) each."""
    if not ("member/force" in results.histories and len(results.time)):
        table = results.table("static_force")
        return {(int(r["element"]), str(r["quantity"])): np.array([r["value"]]) for r in table}
    return dict(zip(_ends(results), results.history("member/force")[choice.span(results)].T))


def _extremes(results: Results, choice: Choice) -> dict[tuple[int, str], tuple[float, float]]:
    """True extremes of the end forces where the whole history is drawn; else empty."""
    if choice.between or "member_envelope" not in results.tables:
        return {}
    table = results.table("member_envelope")
    return {(int(r["element"]), str(r["quantity"])): (float(r["min"]), float(r["max"])) for r in table}


def _point_loads(results: Results) -> dict[int, list[tuple[float, Array]]]:
    """Places and forces of the point loads of every member."""
    loads: dict[int, list[tuple[float, Array]]] = {}
    for element, load in member_loads(results):
        force = np.array([load.get("PX", 0.0), load.get("PY", 0.0)])
        if force.any():
            loads.setdefault(element, []).append((load["AT"], force))
    return loads


def member_loads(results: Results) -> Iterator[tuple[int, dict[str, float]]]:
    """Element and values (``WX``, ``WY``, ``PX``, ``PY``, ``AT``) of every member load, parsed from the
    texts of the table.
    """
    for row in results.table("member_loads") if "member_loads" in results.tables else ():
        values = re.findall(r"(\w+) ([-+.\deE]+)", str(row["load"]))
        yield int(row["element"]), {name: float(value) for name, value in values}
