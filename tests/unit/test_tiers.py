"""What every check runs of a test with several parameters, and what the night adds."""

import pytest

from tiers import at_night, each_once


@pytest.mark.parametrize("count", [1, 2, 4])
def test_every_check_meets_each_value_and_the_night_all_combinations(count):
    loads = {f"load {i}": i for i in range(count)}
    names, cases = each_once(("law, stiffness", [("A", 1.0), ("B", 2.0), ("C", 3.0)]), ("load", loads)).args
    assert names == ["law", "stiffness", "load"]
    assert len({c.values for c in cases}) == len(cases) == 3 * count
    checked = [c.values for c in cases if not c.marks]
    assert len(checked) == max(3, count)
    assert {law for law, *_ in checked} == {"A", "B", "C"} and {x for *_, x in checked} == {*range(count)}
    assert {c.id for c in cases} >= {"('A', 1.0)-load 0"}


def test_cases_of_the_night_bear_its_mark():
    for case, values in zip(at_night("a", ("b", 2)), (("a",), ("b", 2))):
        assert case.values == values and [mark.name for mark in case.marks] == ["slow"]
