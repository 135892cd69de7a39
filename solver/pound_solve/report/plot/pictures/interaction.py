"""Picture `interaction`: axial force over moment of hinges, with the strength of their sections."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
from pound_solve.report.plot import style
from pound_solve.report.plot.members import chosen_members
from pound_solve.report.plot.schema import Choice, Nothing, Picture
from pound_solve.results import Results

MOST = 8  #: panels
REACHED = 1.0 - 1e-9  #: of a yield force, which a perfectly plastic spring reaches but for rounding
SAGGING = {"I": -1.0, "J": 1.0}  #: sign of a sagging moment among the end forces
MARK = {"linestyle": "", "color": "0.1", "zorder": 4}


class MemberHinge(NamedTuple):
    """A hinge at an end of a member.

    Attributes
    ----------
    name : str
        ``11 hinge I``.
    columns : tuple of int
        Of its axial force and its moment in the history ``member/force``.
    sign : float
        Of a sagging moment there.
    springs : ndarray, shape (n,)
        Rows of the table `springs`: one, or those of a BEAM_COLUMN.
    corners : ndarray, shape (m, 2)
        Axial forces and moments of the corners of its diagram [F, F L]; none of a hinge for moments alone.
    """

    name: str
    columns: tuple[int, int]
    sign: float
    springs: NDArray[Any]
    corners: Array

    def path(self, forces: Array) -> tuple[Array, Array]:
        """Moments (sagging positive) and axial forces out of rows of ``member/force``, shape (nt,) each."""
        axial, moment = self.columns
        return self.sign * forces[:, moment], forces[:, axial]

    @property
    def outline(self) -> Array:
        """Moments and axial forces around the diagram, shape (2, m + 1); none of a hinge without one."""
        outline: Array = np.vstack([self.corners, self.corners[:1]])[:, ::-1].T
        return outline

    @property
    def yield_moments(self) -> list[float]:
        """Yield moments of a hinge without a diagram, to both sides where it has them."""
        if len(self.corners):
            return []
        (spring,) = self.springs
        return [float(m) for m in (spring["yield_plus"], spring["yield_minus"]) if np.isfinite(m)]


def interaction(results: Results, choice: Choice) -> Any:
    """Draw a panel for each hinge; of many, first those with a diagram, then those whose axial force
    varies most.
    """
    hinges = list(member_hinges(results, choice))
    if not hinges:
        raise Nothing("members with hinges")
    t, forces = results.course("member/force")
    forces = forces[choice.span(results, t)]
    order = most_varied(hinges, forces)
    few = f"{len(order)} of {len(hinges)} " if len(order) < len(hinges) else ""
    title = f"Axial forces and moments of {few}hinges; tension and sagging positive"
    figure, all_axes = style.panels(len(order), title, (3.4, 2.6) if len(order) > 1 else (6.0, 4.4))
    for axes, k in zip(all_axes, sorted(order)):
        _panel(axes, results, hinges[k], forces, choice)
    style.legend_below(figure, all_axes)
    return figure


def most_varied(hinges: Sequence[MemberHinge], forces: Array) -> list[int]:
    """Indices of the hinges that are drawn: first those with a diagram, then those whose axial force varies
    most.
    """
    change = [float(np.ptp(hinge.path(forces)[1])) for hinge in hinges]
    return sorted(range(len(hinges)), key=lambda k: (not len(hinges[k].corners), -change[k]))[:MOST]


def member_hinges(results: Results, choice: Choice) -> Iterator[MemberHinge]:
    """Hinges of the chosen members, or of all."""
    springs, chosen = results.table("springs"), set(chosen_members(results, choice))
    column = {label: k for k, label in enumerate(results.labels("member/force"))}
    section = {int(e["element"]): str(e["property"]) for e in results.table("elements")}
    diagrams = results.table("interaction") if "interaction" in results.tables else None
    rows: dict[tuple[int, str], list[int]] = {}
    for k, row in enumerate(springs):
        word, _, end = str(row["component"]).partition(" ")
        if word == "hinge" and int(row["element"]) in chosen:
            rows.setdefault((int(row["element"]), end[0]), []).append(k)
    for (element, end), at in rows.items():
        corners = np.zeros((0, 2))
        if diagrams is not None:
            of_section = diagrams[diagrams["property"] == section[element]]
            corners = np.column_stack([of_section["axial"], of_section["moment"]])
        columns = column[f"{element} axial {end}"], column[f"{element} moment {end}"]
        yield MemberHinge(f"{element} hinge {end}", columns, SAGGING[end], springs[at], corners)


def _panel(axes: Any, results: Results, hinge: MemberHinge, forces: Array, choice: Choice) -> None:
    """Draw the strength of a hinge, the path of its forces, and its start, peak and first yields."""
    units = results.units
    style.grid(axes, f"moment [{units.text('F*L')}]", f"axial force [{units.force}]")
    limit = {"color": style.RED, "linestyle": "-", "linewidth": 0.9, "label": "strength"}
    if len(hinge.corners):
        axes.plot(*hinge.outline, **limit)
    for strength in hinge.yield_moments:
        axes.axvline(strength, **{**limit, "label": "yield moment"})
    moment, axial = hinge.path(forces)
    axes.plot(moment, axial, color=style.BLUE, linestyle="-", linewidth=0.6)
    top = int(np.argmax(np.abs(moment)))
    axes.plot(moment[:1], axial[:1], marker="s", markersize=4, label="start", **MARK)
    axes.plot(
        moment[[top]], axial[[top]], "o", fillstyle="none", markersize=6, label="largest moment", **MARK
    )
    first = first_yields(results, hinge, choice)
    if len(first):
        at = hinge.path(results.history("member/force")[first])
        axes.plot(*at, marker="x", markersize=5, label="first yield to each side", **MARK)
    axes.margins(0.08)
    axes.set_title(hinge.name)


def first_yields(results: Results, hinge: MemberHinge, choice: Choice) -> NDArray[np.intp]:
    """Samples at which a spring of a hinge first has its yield force of either side, ascending."""
    labels = results.labels("spring/force")
    column = [labels.index(f"{row['element']} {row['component']}") for row in hinge.springs]
    force, strength = results.history("spring/force")[:, column], hinge.springs
    # NaN, no strength, is never reached
    sides = force >= REACHED * strength["yield_plus"], force <= REACHED * strength["yield_minus"]
    firsts = [np.flatnonzero(reached)[:1] for side in sides for reached in side.T]
    samples = np.unique(np.concatenate(firsts))
    inside = np.arange(len(force))[choice.span(results)]
    return samples[np.isin(samples, inside)]


SPEC = Picture(
    name="interaction",
    place=155,
    shows="axial force over moment of hinges, with the strength of the section",
    needs=("springs", "elements", "member/force", "spring/force"),
    draw=interaction,
    options=("member", "between"),
)
