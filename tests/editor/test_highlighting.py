"""Highlighting: the files are up to date, and the grammar of TextMate colours decks as they are read."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from highlighters import kate, notepad, textmate
from highlighters.words import words
from pound_deck.cards import parse
from pound_deck.expressions import Expression
from pound_deck.sections import CARDS, NAMES
from pound_deck.source import INCLUDE, DeckSource, is_end, without_comment
from pound_solve.catalog import catalog
from pound_solve.report.listing import vocabulary
from refresh_manual import editors

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "manual/editor"
DECKS = sorted((ROOT / "examples").rglob("*.in[pc]"))


def compiled(patterns):
    """Rules as (expression, name, captures, rules for the rest of the line)."""
    for p in patterns:
        assert p.get("end", "$") == "$"
        captures = p.get("captures") or p.get("beginCaptures") or {}
        inner = [*compiled(p.get("patterns", ()))]
        yield re.compile(p.get("match") or p["begin"]), p.get("name"), captures, inner


RULES = [*compiled(textmate.grammar()["patterns"])]


def tokens(line):
    """(start, end, scope) of a line: at each place the rule that matches first, as TextMate does it."""
    out, at, rules = [], 0, RULES
    while at < len(line):
        found = [(m.start(), k, m) for k, rule in enumerate(rules) if (m := rule[0].search(line, at))]
        if not found:
            break
        _, k, m = min(found, key=lambda f: f[:2])
        _, name, captures, inner = rules[k]
        spans = [(m.span(), name)] if name else [(m.span(int(g)), c["name"]) for g, c in captures.items()]
        out += [(a, b, scope.removesuffix(".pound-deck")) for (a, b), scope in spans if b > a]
        assert m.end() > at
        at, rules = m.end(), inner or rules
    return out


def scopes(line):
    return [(line[a:b].strip(), scope) for a, b, scope in tokens(line)]


@pytest.mark.parametrize("name", editors())
def test_the_files_are_up_to_date(name):
    assert (ROOT / "manual" / name).read_text("utf-8") == editors()[name], "run make manual"


@pytest.mark.parametrize(
    "line, expected",
    [
        (
            "NODES   ! number x",
            [("NODES", "entity.name.section"), ("! number x", "comment.line.exclamation")],
        ),
        ("nodes 12", [("nodes", "entity.name.section"), ("12", "constant.numeric")]),
        ("TITLE  Let's go ! now", [("TITLE", "keyword.control"), ("Let", "string.unquoted.title")]),
        ("INCLUDE frame.inc", [("INCLUDE", "keyword.control"), ("frame.inc", "string.other.file")]),
        ("MASS LUMPED", [("MASS", "keyword.control"), ("LUMPED", "variable.other.word")]),
        (
            "  COL  SPRING KX=2*k RULE=TAKEDA",
            [
                ("COL", "entity.name.label"),
                ("SPRING", "support.type.kind"),
                ("KX", "variable.parameter.item"),
                ("=", "keyword.operator"),
                ("2", "constant.numeric"),
                ("*", "keyword.operator"),
                ("k", "variable.other.word"),
                ("RULE", "variable.parameter.item"),
                ("=", "keyword.operator"),
                ("TAKEDA", "support.class.member"),
            ],
        ),
        (
            " HISTORY T=1D-3 METHOD=AUTO",
            [
                ("HISTORY", "support.type.kind"),
                ("T", "variable.parameter.item"),
                ("=", "keyword.operator"),
                ("1D-3", "constant.numeric"),
                ("METHOD", "variable.parameter.item"),
                ("=", "keyword.operator"),
                ("AUTO", "support.class.member"),
            ],
        ),
        (
            "PARAM gap=1",
            [
                ("PARAM", "keyword.control"),
                ("gap", "variable.other.name"),
                ("=", "keyword.operator"),
                ("1", "constant.numeric"),
            ],
        ),
        (
            "PARAM zz = sqrt(pi) &",
            [
                ("PARAM", "keyword.control"),
                ("zz", "variable.other.name"),
                ("=", "keyword.operator"),
                ("sqrt", "support.function"),
                ("pi", "constant.language.pi"),
                ("&", "keyword.operator.continuation"),
            ],
        ),
        (
            "  1 TO 5",
            [("1", "constant.numeric"), ("TO", "keyword.operator.range"), ("5", "constant.numeric")],
        ),
        ('  "a!b" 1 2', [('"a!b"', "string.quoted"), ("1", "constant.numeric"), ("2", "constant.numeric")]),
    ],
)
def test_a_line_in_colour(line, expected):
    found = scopes(line)
    assert found[: len(expected)] == expected and (len(found) == len(expected) or line.startswith("TITLE"))


@pytest.mark.parametrize("path", DECKS, ids=lambda p: p.name)
def test_decks_are_coloured_as_they_are_read(path):
    """What the reader takes for a comment, heading, card, kind, name, number or text looks so."""
    text = path.read_text("utf-8")
    seen = {}
    for number, line in enumerate(text.split("\n"), 1):
        for a, b, scope in tokens(line):
            seen[number, a + 1, b + 1] = scope
        code = without_comment(line)
        if code != line:
            assert seen[number, len(code) + 1, len(line) + 1] == "comment.line.exclamation"
    lines = DeckSource().logical(str(path), text)
    section = ""
    for row in parse((x for x in lines if not INCLUDE.match(x.text) and not is_end(x.text)), []):
        section = row.word if row.word in NAMES else section
        if row.word == "TITLE":
            continue
        for k, item in enumerate(row.items):
            check_item(seen, section, row, k, item)


def check_item(seen, section, row, k, item):
    def scope(span):
        return seen.get((span.line, span.column, span.end))

    first = k == 0 and not item.name
    if first and row.word in NAMES:
        assert scope(item.span) == "entity.name.section"
    elif first and row.word in {spec.name for spec in CARDS}:
        assert scope(item.span) == "keyword.control"
    elif section == "PROPS" and row.word != "PARAM" and k < 2:
        assert scope(item.span) == ("entity.name.label", "support.type.kind")[k]
    elif first and section in ("DAMPING", "EQUAKE", "FORCES", "ANALYSIS"):
        assert scope(item.span) == "support.type.kind"
    elif item.name:
        expected = "variable.other.name" if row.word == "PARAM" else "variable.parameter.item"
        assert scope(item.name_span) == expected, item.name
    for part in item.parts if k > 1 else ():
        for step in part.steps if isinstance(part, Expression) else ():
            if step.kind in ("number", "text"):
                expected = {"number": "constant.numeric", "text": "string.quoted"}[step.kind]
                assert scope(step.span) == expected, step
            if step.kind == "word" and step.text.upper() in catalog().family("hysteresis"):
                assert scope(step.span) == "support.class.member"


def test_every_word_of_the_catalog_is_in_all_three():
    known = vocabulary()
    everything = {name for family in known.families() for name in known.family(family)} | set(NAMES)
    everything |= {f.name for x in known.families() for s in known.family(x).values() for f in s.fields}
    w = words()
    ours = {word for name in w.__slots__ for word in getattr(w, name)}
    assert everything <= ours
    for text in (textmate.text(), notepad.text(), kate.text()):
        assert everything <= set(re.findall(r"[A-Z][A-Z0-9_.]*", text))


def test_notepad_plus_plus_has_what_it_needs():
    root = ElementTree.fromstring((FOLDER / "pound-deck.udl.xml").read_text("utf-8"))
    (language,) = root
    assert root.tag == "NotepadPlus" and [e.tag for e in language] == ["Settings", "KeywordLists", "Styles"]
    lists = {e.get("name"): e.text or "" for e in language.find("KeywordLists")}
    assert set(NAMES) == set(lists["Keywords1"].split()) and lists["Comments"].startswith("00! ")
    assert "TAKEDA" in lists["Keywords4"].split() and "KX" in lists["Keywords3"].split()
    delimiters = re.sub(r"\(\(. EOL\)\)", "", lists["Delimiters"]).split()
    assert [d[:2] for d in delimiters] == [f"{k:02d}" for k in range(24)]
    assert len(language.find("Styles")) == 24


def test_kate_has_what_it_needs():
    root = ElementTree.fromstring((FOLDER / "pound-deck.xml").read_text("utf-8"))
    lists = {e.get("name") for e in root.iter("list")}
    styles = {e.get("name") for e in root.iter("itemData")}
    (context,) = root.iter("context")
    for rule in context:
        assert rule.get("attribute") in styles
        if rule.tag == "keyword":
            assert rule.get("String") in lists
        if rule.tag == "RegExpr":
            re.compile(rule.get("String"))


def test_the_folder_for_vs_code_is_whole():
    package = json.loads((FOLDER / "vscode/package.json").read_text("utf-8"))
    contributes = package["contributes"]
    (language,), (grammar,) = contributes["languages"], contributes["grammars"]
    assert grammar["language"] == language["id"] and grammar["scopeName"] == textmate.SCOPE
    assert json.loads((FOLDER / "vscode" / grammar["path"]).read_text("utf-8")) == textmate.grammar()
    configuration = json.loads((FOLDER / "vscode" / language["configuration"]).read_text("utf-8"))
    assert configuration["comments"]["lineComment"] == "!"
    assert [e.lstrip(".") for e in language["extensions"]] == textmate.grammar()["fileTypes"]
