"""What has no derivative, and what is said about it."""

from __future__ import annotations

from pathlib import Path

import pytest

from pound_solve.driver.request import Request
from pound_solve.sensitivity import Derivatives, NoDerivativeError, derivatives

DECK = """UNITS kN m s
PARAM k=4000 record="elcentro" count=1
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
ELEMENTS
 1 COL 1 2
 2 WALL 2
PROPS
 COL SPRING KX=k {rule}
 WALL CONTACT GAP=0.003 ANGLE=0 LAW={law}
WEIGHTS
 2 400
EQUAKE
 SINE AMPLITUDE=2 PERIOD={period} DURATION=1
ANALYSIS
 {history} METHOD={method}
"""
PLAIN = {"rule": "", "law": "LINEAR K=1E5", "period": "1", "method": "EXACT", "history": "HISTORY 1"}


def answer(folder: Path, names: list[str], **parts: str) -> Derivatives:
    path = folder / "deck.inp"
    path.write_text(DECK.format(**PLAIN | parts), encoding="utf-8")
    return derivatives(Request(str(path)), names)


@pytest.mark.parametrize(
    ("name", "parts", "said"),
    [
        ("k", {"method": "NEWMARK DT=0.01"}, "EXACT or AUTO, and the deck asks for NEWMARK"),
        ("k", {"law": "HERTZ K=1E6"}, "HERTZ of element 2 is curved"),
        ("k", {"law": "STEREOMECHANICS E=0.5"}, "STEREOMECHANICS of element 2 is"),
        ("k", {"rule": "RULE=BOUC_WEN FX=20 R=0.05 N=2"}, "BOUC_WEN of element 1 is curved"),
        ("k", {"history": "MODAL 1 !"}, "follow a HISTORY, and the deck has none"),
        ("record", {}, "record is a text"),
        ("none", {}, "no PARAM none"),
        ("k", {"period": "k/4000"}, "k changes more than numbers"),
    ],
)
def test_a_refusal_says_what_and_why(tmp_path: Path, name: str, parts: dict[str, str], said: str) -> None:
    with pytest.raises(NoDerivativeError, match=said):
        answer(tmp_path, [name], **parts)


def test_auto_is_integrated_by_exact(tmp_path: Path) -> None:
    exact, auto = (answer(tmp_path, ["K"], method=method) for method in ("EXACT", "AUTO"))
    assert exact.values["contact_force"]["2"] > 0.0
    assert exact.slopes["contact_force"]["2"] == pytest.approx(auto.slopes["contact_force"]["2"], rel=1e-14)


def test_without_names_only_the_run_is_returned(tmp_path: Path) -> None:
    bare, whole = (answer(tmp_path, names) for names in ([], ["k"]))
    assert bare.values == whole.values
    assert bare.sequence == whole.sequence != ()
    assert not bare.slopes


REACH = 0.3 * (400.0 / 9.81 / 4000.0) ** 0.5  #: amplitude of the mass that leaves the origin at 0.3 m/s [m]


@pytest.mark.parametrize(
    ("gap", "flagged"),
    [(REACH * (1.0 + 1e-5), "near miss"), (REACH * (1.0 - 1e-7), "grazing"), (0.05 * REACH, "")],
)
def test_a_contact_that_is_only_just_met_or_missed_is_flagged(
    tmp_path: Path, gap: float, flagged: str
) -> None:
    path = tmp_path / "free.inp"
    text = DECK.format(**PLAIN).replace("GAP=0.003", f"GAP={gap!r}")
    text = text.replace("EQUAKE\n SINE AMPLITUDE=2 PERIOD=1 DURATION=1", "INITIAL\n 2 VX=0.3")
    path.write_text(text, encoding="utf-8")
    flags = derivatives(Request(str(path)), ["k"]).flags
    assert bool(flags) == bool(flagged)
    assert all(flagged in flag for flag in flags)


def test_at_its_lower_limit_a_parameter_has_a_derivative_of_one_side(tmp_path: Path) -> None:
    """A dashpot of zero: its derivative is the limit of those of small dashpots."""
    path = tmp_path / "deck.inp"
    path.write_text(DECK.format(**PLAIN | {"law": "KELVIN_VOIGT K=1E5 C=c"}), encoding="utf-8")
    text = path.read_text(encoding="utf-8")

    def slope(c: float) -> float:
        path.write_text(text.replace("count=1", f"count=1 c={c!r}"), encoding="utf-8")
        return float(derivatives(Request(str(path)), ["c"]).slopes["residual_drift"]["building 1 1"][0])

    near, nearer, limit = map(slope, (2e-3, 1e-3, 0.0))
    assert limit == pytest.approx(2.0 * nearer - near, rel=1e-6)
    assert limit != 0.0
