"""Rows that echo the input in the report: what the deck says, defaults marked,
and what follows from it at once.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pound_deck.model import Card, Model
from pound_deck.schema import Field, Kind
from pound_solve.analyses.history import contact_name
from pound_solve.loading.forces.base import Force
from pound_solve.loading.motions.base import Motion
from pound_solve.structure.assembly import Structure
from pound_solve.structure.diaphragms import DiaphragmCollision

Rows = list[tuple[Any, ...]]

GEOMETRY = {
    "SMALL": "small displacements",
    "PDELTA": "axial forces of the static state act along the line between the nodes",
    "PDELTA_MEMBER": "axial forces of the static state act along the bent member",
    "PDELTA_VARYING": "the present axial forces act along the line between the nodes",
    "LARGE": "members turn and lengthen as their nodes move",
}


def text_of(value: Any) -> str:
    """Value of an item as text."""
    if value is None:
        return "-"
    if isinstance(value, tuple):
        return (
            ", ".join(text_of(v) for v in value)
            if len(value) <= 12
            else f"{text_of(value[:10])}, ... ({len(value)})"
        )
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def fields_of(card: Card) -> Iterator[Field]:
    """Fields of a card and of the laws it chose, each once."""
    seen: set[str] = set()
    for spec in (card.spec, *(s for specs in card.laws.values() for s in specs)):
        for f in spec.fields:
            if f.name not in seen:
                seen.add(f.name)
                yield f


def options(model: Model, overridden: set[str]) -> Rows:
    """Rows of ``options``: units, mass, parameters, analyses."""
    u = model.units

    def default(key: str) -> str:
        return "*" if key in model.defaults else ""

    rows: Rows = [
        ("units", f"{u.force} {u.length} {u.time}", default("units"), "names only: nothing is converted"),
        ("gravity", f"{model.gravity:.10g}", default("gravity"), "mass = weight / gravity"),
        ("mass of members", model.mass, default("mass"), ""),
        ("geometry", model.geometry, default("geometry"), GEOMETRY[model.geometry]),
    ]
    for name, value in model.params.items():
        rows.append(
            (
                f"PARAM {name}",
                text_of(value),
                "",
                "set on the command line" if name.lower() in overridden else "",
            )
        )
    for card in model.analyses:
        rows.append((card.spec.name, "", "", card.spec.title))
        for f in fields_of(card):
            rows.append((f"  {f.name}", text_of(card[f.name]), "" if f.name in card.spans else "*", f.doc))
    for f in fields_of(model.output):
        given = f.name in model.output.spans
        rows.append((f"OUTPUT {f.name}", text_of(model.output[f.name]), "" if given else "*", f.doc))
    return rows


def nodes(model: Model) -> Rows:
    """Rows of ``nodes``."""
    return [
        (n.id, n.x, n.y, n.fixed, "".join(n.slaved), next(iter(n.slaved.values()), 0))
        for n in model.nodes.values()
    ]


def elements(model: Model) -> Rows:
    """Rows of ``elements``."""
    out = []
    for e in model.elements.values():
        i, j = model.nodes[e.i], None if e.j is None else model.nodes[e.j]
        length = 0.0 if j is None else math.hypot(j.x - i.x, j.y - i.y)
        out.append((e.id, e.name, e.prop, model.props[e.prop].spec.name, e.i, e.j or 0, length))
    return out


def properties(model: Model) -> Rows:
    """Rows of ``properties``: every item of every set, defaults marked;
    items left out with no default are not shown.
    """
    out = []
    for label, card in model.props.items():
        for f in fields_of(card):
            if card[f.name] is None and f.name not in card.spans:
                continue
            unit = model.units.text(f.unit) if f.kind in (Kind.REAL, Kind.INT) and f.unit != "-" else ""
            out.append(
                (
                    label,
                    card.spec.name,
                    f.name,
                    text_of(card[f.name]),
                    unit,
                    "" if f.name in card.spans else "*",
                )
            )
    return out


def masses(structure: Structure) -> Rows:
    """Rows of ``masses``: nodes with mass, members' shares included."""
    m = structure.nodal_mass
    rows = [(n, m.get((n, 0), 0.0), m.get((n, 1), 0.0), m.get((n, 2), 0.0)) for n in structure.model.nodes]
    return [r for r in rows if any(r[1:])]


def loads(model: Model) -> Rows:
    """Rows of ``loads``."""
    return [(node, c["FX"], c["FY"], c["MZ"]) for c in model.loads for node in c["NODES"]]


def let_go(model: Model) -> str | None:
    """Note of ``loads`` on those that are taken off where the history starts."""
    cards = [c for c in model.loads if c["HELD"] == "NO" and c["NODES"]]
    if not cards:
        return None
    each = "; ".join(f"{c['FX']:.6g} {c['FY']:.6g} {c['MZ']:.6g} on {text_of(c['NODES'])}" for c in cards)
    return f"Taken off where the history starts (HELD=NO): {each}."


def member_loads(model: Model) -> Rows:
    """Rows of ``member_loads``."""
    out = []
    for c in model.member_loads:
        parts = [f"{k} {c[k]:.6g}" for k in ("WX", "WY", "PX", "PY") if c[k]]
        if c["PX"] or c["PY"]:
            parts.append(f"AT {c['AT']:.4g}")
        out += [(e, ", ".join(parts)) for e in c["ELEMENTS"]]
    return out


def damping(structure: Structure) -> Rows:
    """Rows of ``damping``."""
    out = []
    for card, text in structure.damping_texts:
        where = [
            f"{f.name.lower()} {text_of(card[f.name])}"
            for f in card.spec.fields
            if f.name in ("NODES", "PROPS") and card[f.name]
        ]
        out.append(("; ".join(where) or "all", card.spec.name, text))
    return out


def contact_laws(structure: Structure) -> Rows:
    """Rows of ``contact_laws``: what each contact was given and the restitution it really has."""
    model = structure.model
    out = []
    for s in structure.laws:
        if s.role.collides:
            f = s.facts
            name = contact_name(model, s.element)
            k = f"{f['k']:.7g} {model.units.text(f['k_unit'])}"
            mass = f["reduced_mass"] or math.nan
            xi = f["xi"] if math.isfinite(f["xi"]) else math.nan
            out.append(
                (
                    name,
                    s.rule,
                    k,
                    f["c"],
                    xi,
                    f["e_asked"],
                    f["e_given"],
                    mass,
                    f["angle"],
                    f["gap"],
                    f["note"],
                )
            )
    return out


def diaphragms(structure: Structure, diaphragm_collisions: Mapping[int, DiaphragmCollision]) -> Rows:
    """Rows of ``diaphragms``: both sides of every contact; `diaphragm_collisions` by the number of the
    law.
    """
    out = []
    for i, m in diaphragm_collisions.items():
        name = contact_name(structure.model, structure.laws[i].element)
        nothing = (math.nan, math.nan)
        alphas = (m.pair.alpha_lumped, m.pair.alpha_paper, m.pair.alpha) if m.pair else (nothing,) * 3
        for n, (side, d) in enumerate(zip("IJ", m.sides)):
            finite = [x if math.isfinite(x) else math.nan for x in (d.stiffness, d.impedance, d.period)]
            period = finite[2] or math.nan
            out.append((name, side, d.mass, finite[0], finite[1], period, *(a[n] for a in alphas)))
    return out


def collision_theory(structure: Structure, diaphragm_collisions: Mapping[int, DiaphragmCollision]) -> Rows:
    """Rows of ``collision_theory``: what the theory of two diaphragms says of every contact."""
    out: Rows = []
    for i, m in diaphragm_collisions.items():
        name = contact_name(structure.model, structure.laws[i].element)
        if m.pair is None:
            out.append((name, *[math.nan] * 5, m.note))
            continue
        p = m.pair
        out.append((name, p.e_paper, p.e, p.duration, p.force, 100.0 * m.lumped_error, m.note))
    return out


def size(structure: Structure) -> Rows:
    """Rows of ``size``; those of the DOFs add up to the unknowns."""
    nodes, moved = structure.model.nodes.values(), len(structure.dofs.moved)
    fixed = sum(len(n.fixed) for n in nodes) - moved
    slaved = sum(len(set(n.slaved) - set(n.fixed)) for n in nodes)
    internal = sum(d >= 3 for _, d in structure.dofs.free)
    contacts = sum(x.role.collides for x in structure.laws)
    counts = {
        "nodes": len(nodes),
        "elements": len(structure.model.elements),
        "degrees of freedom of nodes": 3 * len(nodes),
        "less fixed": fixed,
        "less prescribed at moved supports": moved,
        "less slaved": slaved,
        "plus internal of elements (hinges)": internal,
        "unknowns before reduction": structure.n_free,
        "hysteretic components": len(structure.laws) - contacts,
        "contacts": contacts,
    }
    return [(item, str(count)) for item, count in counts.items()]


def motions(items: Sequence[Motion]) -> Rows:
    """Rows of ``motions``."""
    out = []
    for n, m in enumerate(items, 1):
        i = m.info
        name = " ".join(str(i[k]) for k in ("name", "component") if i.get(k)) or str(i.get("kind") or "")
        out.append(
            (
                f"{n} {name}",
                "R (rad)" if m.direction == "R" else m.direction,
                "all" if m.supports is None else text_of(m.supports),
                str(i.get("format") or i.get("kind") or ""),
                int(i.get("npts") or 0),
                float(i.get("dt") or math.nan),
                float(i["scale"]),
                float(i["pga"]),
                float(i["t_pga"]),
                float(i["pgv"]),
                float(i["pgd"]),
                float(i.get("start") or 0.0),
                float(m.acceleration.end),
                str(i.get("sha256") or ""),
            )
        )
    return out


def forces(items: Sequence[Force]) -> Rows:
    """Rows of ``forces``."""
    out = []
    for n, f in enumerate(items, 1):
        t_peak, peak = f.history.peak()
        name = f"{n} {f.info.get('name', f.info['kind'])}"
        out.append((name, text_of(f.nodes), *f.push, peak, t_peak, f.history.end))
    return out
