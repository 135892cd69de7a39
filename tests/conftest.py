"""One thread for linear algebra, as the program has it; and the examples of property tests.

Property tests try the same examples in every run, so that a red run is the change's own fault.
``--hypothesis-profile=search`` tries new ones; what it finds becomes an ``@example`` of the test.
No example is timed: a loaded machine is no fault.
"""

from hypothesis import settings

from pound_solve.numerics import threads

threads.one()  # before a test imports numpy

settings.register_profile("repeated", derandomize=True, deadline=None)
settings.register_profile("search", deadline=None, print_blob=True)
settings.load_profile("repeated")
