from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from output import sample
from pound_solve.results import Results, Writer


@pytest.fixture(scope="session")
def done(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Results]:
    """Results of a run that came to its end."""
    with Results.open(sample.write(tmp_path_factory.mktemp("sample") / "sample.h5")) as results:
        yield results


@pytest.fixture
def writer(tmp_path: Path) -> Iterator[Writer]:
    """A writer of an empty file `out.h5`."""
    with Writer(tmp_path / "out.h5", title="t", units=sample.UNITS, program_version="0") as writer:
        yield writer
