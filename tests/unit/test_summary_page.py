"""The first page of a report: buildings, struck members, places in words; checked against the histories."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pound_solve
from pound_solve.report.text import render
from pound_solve.results import Results
from pound_solve.results.contents import SECTIONS

#: a two-storey frame beside a mast that its roof strikes between the ends of a column
FRAMES = """
UNITS kN m s
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 4 0 FIX=XYR
 11 0 3
 12 4 3
 21 0 6
 22 4 6
 3 4.02 0 FIX=XYR
 13 4.02 3
 23 4.02 6
 33 4.02 8
ELEMENTS
 1 COLUMN 1 11
 2 COLUMN 12 2
 3 COLUMN 11 21
 4 COLUMN 12 22
 11 BEAM 11 12
 12 BEAM 22 21
 31 MAST 3 13
 32 MAST 13 23
 33 MAST 23 33
 90 POUND 22 23 NAME=roof
PROPS
 COLUMN FRAME E=28E6 A=0.16 I=2E-3 MI=80 MJ=80 LP=0.2 RULE=BILINEAR R=0.05
 BEAM FRAME E=28E6 A=0.11 I=1E-3 MI=40 MJ=50 LP=0.2 RULE=BILINEAR R=0.05
 MAST FRAME E=28E6 A=0.16 I=4E-3
 POUND CONTACT GAP=0.002 LAW=LINEAR K=1E5
WEIGHTS
 11,12,21,22 100
 13,33 80
 23 1
BUILDINGS
 frame NODES=1
LIMITS
 serviceable DRIFT=0.002
 safe DRIFT=0.04 ROTATION=0.001
DAMPING
 RAYLEIGH XI=0.05 MODES=1,2
EQUAKE
 SINE AMPLITUDE=4 PERIOD=0.5
ANALYSIS
 MODAL 6
 HISTORY 1.5 {method}
OUTPUT
 EVERY=0.001
 {output}
"""


def run(folder: Path, method: str = "METHOD=NEWMARK DT=0.0005", output: str = "") -> Results:
    deck = folder / "frames.inp"
    deck.write_text(FRAMES.format(method=method, output=output), encoding="utf-8")
    return pound_solve.run(deck)


@pytest.fixture(scope="module")
def results(tmp_path_factory: Any) -> Iterator[Results]:
    with run(tmp_path_factory.mktemp("frames")) as out:
        yield out


def test_limits_are_compared_with_the_largest_drift_and_rotation(results: Results) -> None:
    limits, storeys = results.table("limits"), results.table("storey_envelope")
    assert [(r["limit"], r["quantity"], r["allowed"]) for r in limits] == [
        ("serviceable", "storey drift", 0.2), ("safe", "storey drift", 4.0),
        ("safe", "plastic rotation", 0.001),
    ]  # fmt: skip
    drifts = {(r["building"], r["storey"]): 100.0 * r["drift"] for r in storeys}
    worst = max(drifts, key=lambda place: drifts[place])
    for row in limits[:2]:
        assert row["place"] == f"{worst[0]} storey {worst[1]}"
        assert row["largest"] == pytest.approx(drifts[worst], rel=1e-12)
        assert row["ratio"] == pytest.approx(row["largest"] / row["allowed"], rel=1e-12)
        assert row["beyond"] == sum(ratio > row["allowed"] for ratio in drifts.values())
    assert limits["beyond"][0] > 0 == limits["beyond"][1]
    hinges, rotation = results.table("worst_hinges"), limits[2]
    top = hinges[np.nanargmax(hinges["rotation"])]
    assert rotation["largest"] == top["rotation"]
    assert rotation["place"] == f"{top['element']} {top['component']}, {top['location']}"
    assert rotation["ratio"] == pytest.approx(top["rotation"] / 0.001, rel=1e-12)
    for hinge in hinges:
        assert (hinge["state"] == "beyond safe") == (hinge["rotation"] > 0.001)


def test_a_deck_without_storeys_or_hinges_has_nothing_to_compare(tmp_path: Path) -> None:
    deck = tmp_path / "deck.inp"
    deck.write_text(
        "NODES\n 1 0 0 FIX=XYR\n 2 0 0 FIX=YR\nELEMENTS\n 1 A 1 2\nPROPS\n A SPRING KX=100\n"
        "WEIGHTS\n 2 9.81\nLIMITS\n safe DRIFT=0.02 ROTATION=0.01\nINITIAL\n 2 UX=1\nANALYSIS\n HISTORY 1\n"
    )
    with pound_solve.run(deck) as results:
        for row in results.table("limits"):
            assert np.isnan(row["largest"]) and np.isnan(row["ratio"])
            assert (row["beyond"], row["place"]) == (0, "")


def test_buildings_have_their_own_periods_weights_shears_and_drifts(results: Results) -> None:
    frame, mast = results.table("building_summary")
    assert (frame["building"], frame["storeys"], mast["storeys"]) == ("frame", 2, 2)
    assert (frame["weight"], mast["weight"]) == pytest.approx((400.0, 161.0))
    mode_of = {(r["building"], r["mode"]): r["kinetic"] for r in results.table("mode_buildings")}
    modes = results.table("modes")
    for row in (frame, mast):
        mine = next(m for m in modes if mode_of.get((row["building"], m["mode"]), 0.0) > 50.0)
        assert row["period"] == mine["period"]
        assert row["modal_mass"] == pytest.approx(1000.0 * mine["mass_x"] / row["weight"])
        labels = results.labels("building/base")
        shear = np.abs(results.history("building/base")[:, labels.index(f"{row['building']} shear X")])
        assert row["shear"] == pytest.approx(shear.max(), rel=1e-3)
        assert row["shear_ratio"] == pytest.approx(row["shear"] / row["weight"])
        storeys = results.table("storey_envelope")
        of = storeys[storeys["building"] == row["building"]]
        assert row["drift"] == pytest.approx(100.0 * of["drift"].max())
        assert row["drift_storey"] == of["storey"][of["drift"].argmax()]
    assert frame["period"] != mast["period"]


def test_struck_members_have_the_forces_of_the_close_ups_and_of_the_envelopes(results: Results) -> None:
    table = results.table("struck_members")
    assert [(r["element"], r["end"]) for r in table] == [(4, "J"), (32, "J"), (33, "I")]
    assert list(table["location"]) == [
        "frame, column 2 head",
        "building 2, column 2 at 6 m",
        "building 2, column 2 at 6 m",
    ]
    (collision,) = results.table("contact_summary")
    envelope = {(r["element"], r["quantity"]): r for r in results.table("member_envelope")}
    t, rows = results.course("member/force")
    at = int(np.argmin(np.abs(t - collision["t_peak"])))
    labels = results.labels("member/force")
    for row in table:
        assert row["t_peak"] == collision["t_peak"]
        name = f"{row['element']} shear {row['end']}"
        assert row["shear_at_peak"] == pytest.approx(abs(rows[at, labels.index(name)]), rel=1e-12)
        for quantity in ("shear", "moment"):
            e = envelope[row["element"], f"{quantity} {row['end']}"]
            assert row[quantity] == max(e["max"], -e["min"])
            assert row[f"t_{quantity}"] == (e["t_max"] if e["max"] >= -e["min"] else e["t_min"])
    assert table["yield_moment"][0] == 80.0 and np.isnan(table["yield_moment"][1:]).all()
    # between the two parts of the mast the contact's force is the jump of the shear
    jump = abs(rows[at, labels.index("32 shear J")] + rows[at, labels.index("33 shear I")])
    assert 0.5 * collision["peak_force"] < jump


def test_without_close_ups_the_shear_at_the_peak_is_not_known(tmp_path: Path) -> None:
    with run(tmp_path, output="CLOSEUPS=0") as results:
        table = results.table("struck_members")
        assert len(table) == 3 and np.isnan(table["shear_at_peak"]).all() and (table["shear"] > 0.0).all()


def test_hinges_are_named_by_storey_and_end(results: Results) -> None:
    named = {(r["element"], r["component"]): r["location"] for r in results.table("worst_hinges")}
    expected = {
        (1, "hinge I"): "frame, column 1 foot",
        (1, "hinge J"): "frame, column 1 head",
        (2, "hinge I"): "frame, column 1 head",  # from the head to the foot
        (2, "hinge J"): "frame, column 1 foot",
        (11, "hinge I"): "frame, beam 1 left",
        (11, "hinge J"): "frame, beam 1 right",
        (12, "hinge I"): "frame, beam 2 right",  # from the right to the left
        (12, "hinge J"): "frame, beam 2 left",
    }
    assert len(named) >= 3 and named.items() <= {**expected, **named}.items()
    assert all(named[key] == expected[key] for key in named if key in expected)


def test_sections_are_numbered_without_holes(results: Results) -> None:
    import re

    numbers = re.findall(r"^(\d+)(?:\.(\d+))?  [A-Z]", render(results), re.MULTILINE)
    sections = [int(n) for n, part in numbers if not part]
    assert sections == list(range(1, len(sections) + 1)) and len(sections) < len(SECTIONS)
    for section in sections:
        tables = [int(part) for n, part in numbers if part and int(n) == section]
        assert tables == list(range(1, len(tables) + 1))


def test_the_peak_of_a_motion_within_a_shorter_history_is_told(tmp_path: Path) -> None:
    times, values = (0.0, 0.5, 1.0, 3.0, 4.0), (0.0, 1.0, 0.0, 6.0, 0.0)
    (tmp_path / "a.txt").write_text("".join(f"{np.interp(0.01 * k, times, values)}\n" for k in range(401)))
    text = FRAMES.format(method="METHOD=NEWMARK DT=0.0005", output="")
    deck = tmp_path / "frames.inp"
    deck.write_text(text.replace("SINE AMPLITUDE=4 PERIOD=0.5", "RECORD a.txt DT=0.01 UNIT=M/S2"))
    with pound_solve.run(deck) as results:
        told = dict(results.table("overview").tolist())["ground motion"]
    assert "peak 6 m/s^2, 0.6 of gravity (within the 1.5 s of the history 1.5 m/s^2)" in told
