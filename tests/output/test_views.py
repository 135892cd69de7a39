"""Tables that the report prints in another shape than they are stored in: nothing is lost on the way."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from output.test_report import only
from pound_solve.report.views.instants import digits
from pound_solve.report.views.ranges import numbers, stepping

__all__ = ("only",)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ([], ""),
        ([7], "7"),
        ([3, 4], "3 to 4"),
        ([3, 5], "3, 5"),
        ([1, 2, 3, 7], "1 to 3, 7"),
        ([101, 201, 301, 302], "101 to 301 by 100, 302"),
        ([5, 4, 3], "5 to 3"),
    ],
)
def test_numbers_as_ranges(given: list[int], told: str) -> None:
    assert numbers(given) == told


def spread(text: str) -> list[int]:
    """Numbers of a text of ranges."""
    out: list[int] = []
    for part in text.split(", ") if text else []:
        first, last, step = re.fullmatch(r"(-?\d+)(?: to (-?\d+))?(?: by (-?\d+))?", part).groups()
        by = int(step or (1 if int(last or first) >= int(first) else -1))
        out += range(int(first), int(last or first) + (1 if by > 0 else -1), by)
    return out


@given(st.lists(st.integers(1, 40), unique=True))
def test_ranges_hold_every_number_in_its_order(given: list[int]) -> None:
    assert spread(numbers(given)) == given


CELLS = st.tuples(
    st.integers(1, 9),
    st.sampled_from(("", "XYR")),
    st.sampled_from((0.0, 1.5, 3.0, 4.5)),
    st.integers(0, 2),
)


@given(st.lists(CELLS))
def test_rows_in_ranges_come_back(rows: list[tuple[int, str, float, int]]) -> None:
    back: list[tuple[object, ...]] = []
    for first, last, count in stepping(rows):
        for k in range(count):
            share = k / (count - 1) if count > 1 else 0.0
            back.append(
                tuple(a if isinstance(a, str) else a + (b - a) * share for a, b in zip(first, last))
            )
    assert [row[1] for row in back] == [row[1] for row in rows]
    for got, want in zip(back, rows, strict=True):
        assert [got[0], *got[2:]] == pytest.approx([want[0], *want[2:]], abs=1e-12)


@pytest.mark.parametrize(("last", "decimals"), [(0.0, 3), (20.0, 3), (0.02, 5), (3600.0, 3)])
def test_instants_keep_four_digits(last: float, decimals: int) -> None:
    assert digits(last) == decimals


def lines_of(text: str, first: str) -> list[list[str]]:
    """Cells of the lines that begin with a cell."""
    return [x.split() for x in text.split("\n") if x.split()[:1] == [first]]


def test_a_node_has_one_row_for_each_quantity(only: Callable[..., str]) -> None:
    rows = [
        (7, "X", "displacement", "m", 0.25, 1.5, -0.125, 2.5),
        (7, "R", "displacement", "rad", 0.002, 3.5, -0.001, 4.5),
        (7, "X", "acceleration", "m/s^2", 9.5, 1.25, -8.5, 2.25),
        (8, "X", "displacement", "m", 0.75, 1.75, -0.5, 2.75),
    ]
    text = only(node_envelope=rows)
    u, a = lines_of(text, "7")
    assert u == ["7", *["0.25", "1.500", "-0.125", "2.500", "0.002", "3.500", "-0.001", "4.500"]]
    assert a == ["7", "9.5", "1.250", "-8.5", "2.250"]
    assert lines_of(text, "8") == [["8", *["0.75", "1.750", "-0.500", "2.750", "-", "-", "-", "-"]]]
    heads = text[: text.index("7 ")]
    assert "displacement" in text and heads.count("[m]") == 2 and heads.count("[rad]") == 2


def test_an_end_of_a_member_tells_what_its_hinge_did(only: Callable[..., str]) -> None:
    extremes = (5.0, 1.5, -4.0, 2.5)
    names = (
        "axial I",
        "shear I",
        "moment I",
        "moment hinge I",
        "axial J",
        "shear J",
        "moment J",
        "moment hinge J",
    )
    turned = (4.0, 2.5, -5.0, 1.5)
    values = {"moment hinge I": turned, "moment hinge J": (4.5, 1.5, -4.0, 2.5)}  # J has a rigid end
    members = [(3, n, "kN*m" if "moment" in n else "kN", *values.get(n, extremes)) for n in names]
    members.append((9, "force X", "kN", *extremes))
    springs = [(3, "hinge I", "TAKEDA", "kN*m", 1.0, -1.0, "rad", 1.0, -1.0, 6, 3.25, 2.0)]
    damage = [(3, "hinge I", 8.0, 3.25, 0.5, 0.25, 0.75, 1.0)]
    text = only(member_envelope=members, spring_envelope=springs, damage=damage)
    start = text.index("MEMBER ENVELOPES")
    own = text[start : text.index("SPRING ENVELOPES")]
    i, j, rest = lines_of(own, "3")
    assert i == [
        "3",
        "I",
        *["5.0", "-4.0", "5.0", "-4.0", "5.0", "1.500", "-4.0", "2.500", "3.25", "6", "0.75"],
    ]
    assert j[:2] == ["3", "J"] and j[-2:] == ["-", "-"]
    assert rest[:4] == ["3", "moment", "hinge", "J"]
    assert lines_of(own, "9") == [["9", "force", "X", "kN", "5.0", "1.500", "-4.0", "2.500"]]


def test_equal_values_stand_once(only: Callable[..., str]) -> None:
    rows = [(n, 9.0, 9.0, 0.0) for n in (101, 103, 201, 202, 203)] + [(7, 1.0, 0.0, 0.0)]
    text = only(masses=rows)
    assert re.search(r"^  101, 103, 201 to 203 +9\.0 +9\.0 +0\.0$", text, re.MULTILINE)
    assert re.search(r"^  7 +1\.0 +0\.0 +0\.0$", text, re.MULTILINE)


def test_nodes_and_elements_in_ranges(only: Callable[..., str]) -> None:
    nodes = [(n, 6.0 * n, 0.0, "XYR", "", "") for n in (1, 2, 3)] + [(9, 1.0, 2.0, "", "", "")]
    nan = math.nan
    elements = [(n, "", "C", "FRAME", n, n + 100, 3.5) for n in (11, 12)] + [
        (20, "", "W", "CONTACT", 9, 0, nan)
    ]
    text = only(nodes=nodes, elements=elements)
    assert re.search(r"^  1 to 3 +6 to 18 +0 +XYR$", text, re.MULTILINE)
    assert re.search(r"^  11 to 12 +C +FRAME +11 to 12 +111 to 112 +3\.5$", text, re.MULTILINE)
    assert re.search(r"^  20 +W +CONTACT +9 +ground +-$", text, re.MULTILINE)
