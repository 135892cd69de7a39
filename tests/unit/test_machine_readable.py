"""``check --json`` and ``list --json`` keep the schemas of the manual and say what the plain verbs say."""

import json
import re
from pathlib import Path

import pytest

from pound_deck.messages import MESSAGES
from pound_deck.schema import REQUIRED, Kind
from pound_deck.sections import NAMES
from pound_solve.cli.main import main
from pound_solve.report.listing import vocabulary

ROOT = Path(__file__).parents[2]
BAD = ROOT / "tests/parser/bad"


def schema(name):
    """Names of a table of the manual."""
    page = (ROOT / "manual/tools.md").read_text("utf-8")
    rows = page.split(f"<!-- table: json {name} -->")[1].split("<!-- end -->")[0]
    return re.findall(r"^\| `(\w+)`", rows, re.M)


def printed(capsys, *words):
    status = main([*words, "--json"])
    return status, json.loads(capsys.readouterr().out)


def places(text):
    """Places and numbers of the messages of plain ``check``."""
    return {(int(a), int(b), c) for a, b, c in re.findall(r":(\d+):(\d+): (?:error|warning) (\w+):", text)}


@pytest.mark.parametrize("path", sorted(BAD.glob("*.inp"))[::6], ids=lambda p: p.stem)
def test_check_prints_the_messages_of_plain_check(path, capsys):
    plain = main(["check", str(path)])
    told = capsys.readouterr().err
    status, out = printed(capsys, "check", str(path))
    assert status == plain and out["good"] == (plain == 0)
    assert list(out) == schema("check") and out["deck"] == str(path)
    found = out["diagnostics"]
    assert {(d["line"], d["column"], d["number"]) for d in found if d["line"]} == places(told)
    for d in found:
        assert list(d) == schema("diagnostic")
        assert f"{d['number']}: {d['text']}" in told and d["hint"] in told
        assert d["title"] == MESSAGES[d["number"]][0] and d["severity"] in ("error", "warning")
        assert d["line"] is None or d["column"] < d["end_column"]


def test_check_of_a_good_deck_tells_its_size(capsys):
    status, out = printed(capsys, "check", str(ROOT / "examples/07_row_of_three/row_of_three.inp"))
    assert status == 0 and out["good"] and out["diagnostics"] == []
    main(["check", out["deck"]])
    numbers = re.findall(r"(\d+) (nodes|elements|unknowns)", capsys.readouterr().out)
    assert out["size"] == {name: int(n) for n, name in numbers}


def test_a_deck_that_is_not_there_gives_a_line_and_no_json(tmp_path, capsys):
    assert main(["check", str(tmp_path / "none.inp"), "--json"]) == 3
    out, err = capsys.readouterr()
    assert not out and "No such file" in err


def test_list_prints_the_whole_catalog(capsys):
    status, out = printed(capsys, "list")
    assert status == 0 and list(out) == schema("list")
    assert [s["name"] for s in out["sections"]] == list(NAMES)
    known = vocabulary()
    assert list(out["families"]) == list(known.families())
    assert all(s["family"] in (None, *out["families"]) for s in out["sections"])
    assert [c["name"] for c in out["cards"]][:2] == ["TITLE", "UNITS"]
    for family, members in out["families"].items():
        specs = known.family(family)
        assert [m["name"] for m in members] == list(specs)
        for member in members:
            assert list(member) == schema("member")
            for item, f in zip(member["items"], specs[member["name"]].fields, strict=True):
                assert list(item) == schema("item")
                assert (item["name"], item["kind"], item["unit"]) == (f.name, f.kind.value, f.unit)
                assert item["required"] == (f.default is REQUIRED) and item["meaning"] == f.doc
                assert bool(item["family"]) == (f.kind is Kind.FAMILY)


def test_the_manual_names_every_kind_of_item():
    page = (ROOT / "manual/tools.md").read_text("utf-8")
    row = next(line for line in page.splitlines() if line.startswith("| `kind` |"))
    assert re.findall(r"`(\w+)`", row)[1:] == [kind.value for kind in Kind]
