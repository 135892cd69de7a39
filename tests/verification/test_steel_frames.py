"""The steel frames of ``examples/frames`` against OpenSees 3.7.1 with the same assumptions and steps.

The peer's numbers come from ``benchmarks/pair_frames.py frames --case small 10x3 20x6 --peaks``, which runs
``benchmarks/opensees_steel_frame.py`` under the motion of the decks: its Newton iterations stop below
1e-6 kN, and peaks are taken at the steps.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest

from decks import results_of
from kernels import FAST
from tiers import at_night
from verification.cases import ROOT

pytestmark = pytest.mark.full

FRAMES = ROOT / "examples" / "frames"


@dataclass(frozen=True)
class Peaks:
    """Largest and smallest drift of the roof [m]; largest rotations of some hinges, and their sum over all
    [rad].
    """

    roof: tuple[float, float]
    some: Mapping[str, float]
    all: float


SMALL = {"storeys": 2, "pga": 12, "t": 5}
PEER = {
    ("small", "SMALL"): Peaks(
        (0.126148891254, -0.0947517176533),
        {"153 hinge I": 0.00766260219514, "151 hinge I": 0.0090616752264, "153 hinge J": 0.00909681113938},
        0.0850270134556,
    ),
    ("10x3", "SMALL"): Peaks(
        (0.258433851901, -0.331904835082),
        {"251 hinge I": 0.00524300171253, "353 hinge J": 0.00541534784821, "351 hinge I": 0.00585739014205},
        0.1285573192,
    ),
    ("10x3", "PDELTA"): Peaks(
        (0.261446996637, -0.384455285796),
        {"451 hinge I": 0.00743453863201, "353 hinge J": 0.00777693191865, "351 hinge I": 0.00822816411118},
        0.192501479834,
    ),
    ("20x6", "SMALL"): Peaks(
        (0.871836467272, -0.58265770335),
        {"955 hinge J": 0.00933812085514, "1056 hinge J": 0.00974791482252, "956 hinge J": 0.0100748679126},
        0.894835854527,
    ),
    ("20x6", "PDELTA"): Peaks(
        (0.859552839049, -0.550332671887),
        {
            "1056 hinge J": 0.00832941749338,
            "856 hinge J": 0.00885295248672,
            "956 hinge J": 0.00904860804068,
        },
        0.805406184593,
    ),
}


def peaks(deck: str, geometry: str, **params: object) -> tuple[tuple[float, float], dict[str, float]]:
    """Peaks of one run at its steps, as the peer takes them."""
    text = (FRAMES / f"{deck}.inp").read_text(encoding="utf-8")
    for old, new in (("GEOMETRY PDELTA", f"GEOMETRY {geometry}"), ("EVERY=every", "EVERY=every NODES=1")):
        assert text.count(old) == 1
        text = text.replace(old, new)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "deck.inp"
        path.write_text(text, encoding="utf-8")
        with results_of(path, {"every": 0.005, "events": '"STEPPED"', **params}, out=folder) as r:
            assert r.status == "done"
            roof = r.history("drift")[:, 0]
            hinges = abs(r.history("spring/deformation")[1:]).max(axis=0).tolist()  # not the state at rest
            names = r.labels("spring/deformation")
    return (float(roof.max()), float(roof.min())), dict(zip(names, hinges, strict=True))


def compare(
    case: str, deck: str, geometry: str, of_roof: float, of_hinges: float, **params: object
) -> None:
    """Roof and hinges, each to a share of the largest of its kind."""
    peer = PEER[case, geometry.removesuffix("_VARYING")]
    roof, hinges = peaks(deck, geometry, **params)
    assert roof == pytest.approx(peer.roof, abs=of_roof * max(map(abs, peer.roof)))
    largest = max(peer.some.values())
    assert max(hinges, key=hinges.__getitem__) == max(peer.some, key=peer.some.__getitem__)
    assert {k: hinges[k] for k in peer.some} == pytest.approx(peer.some, abs=of_hinges * largest)
    assert sum(hinges.values()) == pytest.approx(peer.all, rel=of_hinges)


def test_two_storeys() -> None:
    compare("small", "steel_10x3", "SMALL", 1e-9, 1e-9, **SMALL)


@FAST
@pytest.mark.parametrize("case", ["10x3", *at_night("20x6")])
def test_small_displacements(case: str) -> None:
    compare(case, f"steel_{case}", "SMALL", 1e-9, 1e-9)


@FAST
@pytest.mark.parametrize("case", ["10x3", *at_night("20x6")])
def test_constant_axial_forces(case: str) -> None:
    """OpenSees takes the present axial forces, GEOMETRY PDELTA those under gravity: close, not equal."""
    compare(case, f"steel_{case}", "PDELTA", 3e-5, 4e-3)


@FAST
@pytest.mark.parametrize("case", ["10x3", *at_night("20x6")])
def test_present_axial_forces(case: str) -> None:
    compare(case, f"steel_{case}", "PDELTA_VARYING", 1e-6, 3e-6)
