"""What every contact law of straight branches keeps: no branch is steeper than it states."""

import pytest

from pound_solve.assess.law_test import protocol, specimen
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import transitions
from samples import has_loop

CONTACTS = {name: specimen(spec)[0] for name, spec in catalog().family("contact").items() if has_loop(spec)}


@pytest.mark.parametrize("name", [name for name, spring in CONTACTS.items() if not spring.law.curved])
def test_no_branch_is_steeper_than_stated(name: str) -> None:
    """The limit of CENTRAL's step counts on that."""
    spring = CONTACTS[name]
    state, at, seen = spring.law.start(), 0.0, [0.0]
    for goal in protocol(spring):
        for _, after in transitions(spring.law, state, at, goal):
            state = after
            seen.append(spring.branch(state).stiffness)
        at = goal
    assert 0.0 < max(seen) <= spring.steepest * (1.0 + 1e-9)
