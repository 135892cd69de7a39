"""Linear elastic: ``f = k d``."""

from pound_deck.schema import Spec

# a spring with this rule is part of the linear stiffness of the structure and needs no law object
SPEC = Spec("hysteresis", "ELASTIC", "linear elastic", code=0, reference="Hooke", impl=None)
