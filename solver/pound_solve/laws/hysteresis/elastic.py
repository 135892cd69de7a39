"""Linear elastic: ``f = k d``."""

from pound_deck.schema import Spec

# a spring with this rule is part of the structure's linear stiffness: it needs no law object
SPEC = Spec("hysteresis", "ELASTIC", "linear elastic", code=0, reference="Hooke", impl=None)
