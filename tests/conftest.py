"""One thread for linear algebra, as the program has it; the examples of property tests; garbage collection.

Property tests try the same examples in every run, so that a red run is the change's own fault.
``--hypothesis-profile=search`` tries new ones; what it finds becomes an ``@example`` of the test.
No example is timed: a loaded machine is no fault.
"""

import gc
from collections.abc import Generator
from pathlib import Path

import pytest
from hypothesis import settings

import pound_solve
from pound_solve.numerics import threads

threads.one()  # before a test imports numpy

from pound_solve.numerics.providers import provider  # noqa: E402

if not Path(pound_solve.__file__).is_relative_to(Path(__file__).parents[1]):
    pytest.exit(
        f"these tests would test {pound_solve.__file__}: install this checkout, or set PYTHONPATH", 2
    )

settings.register_profile("repeated", derandomize=True, deadline=None)
settings.register_profile("search", deadline=None, print_blob=True)
settings.load_profile("repeated")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Keep the collected tests, which stay to the end, out of later garbage collections."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.fixture(autouse=True)
def provider_of_the_process() -> Generator[None]:
    """Choose what makes kernels ready before a test may set POUND_COMPILE, and again after one that has
    forgotten the choice: else what such a test sets would hold for all tests that follow.
    """
    provider()
    yield
    provider()
