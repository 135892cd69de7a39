"""Models of OpenSees changed at random: each is read or told at a place that exists; none does more."""

from __future__ import annotations

import io
import json
import random

import pytest

from imports.damage import damaged
from imports.opensees_models import FIBRES, FRAME, POUNDING
from pound_deck.diagnostics import has_errors
from pound_deck.model import Span
from pound_deck.reader import read_text
from pound_import.opensees.commands import Command
from pound_import.opensees.importer import translate
from pound_import.opensees.recorder import CommandRecorder
from pound_import.opensees.replay import Replayed
from pound_solve.catalog import catalog

pytest.importorskip("tkinter")
CATALOG = catalog()
MODELS = (FRAME, POUNDING, FIBRES)
WORDS = (
    *(
        "0",
        "-1",
        "1e400",
        "nan",
        "1e-320",
        "99999999999",
        "1.5",
        "2",
        "x",
        "{}",
        "{",
        "}",
        "[",
        "]",
        "$",
        '"',
    ),
    *(
        "-mass",
        "-dir",
        "-orient",
        "-factor",
        "-values",
        "Steel01",
        "Parallel",
        "Hysteretic",
        "Linear",
        "Path",
    ),
    *("element", "node", "fix", "wipe", "section", "pattern", "eigen", "analyze", "exit", "error", "break"),
    *(
        "[exec touch HERE]",
        "[open HERE w]",
        '[open "|touch HERE" r]',
        "[file delete model.tcl]",
        "[source /etc/hosts]",
    ),
)


def recorded(folder, text: str) -> Replayed:
    """Commands of a model, replayed in this process."""
    from pound_import.opensees.tcl_model import TclModel

    path = folder / "model.tcl"
    path.write_text(text, encoding="utf-8")
    sent = io.StringIO()
    TclModel(path, CommandRecorder(sent, io.StringIO('{"values": [64.0, 676.0]}\n' * 50))).run(2.0)
    replayed = Replayed()
    for line in sent.getvalue().splitlines():
        item = json.loads(line)
        if isinstance(item, list):
            replayed.commands.append(Command(tuple(item[0]), Span(item[1], item[2], 1, 2)))
    return replayed


def check(folder, rng: random.Random) -> bool:
    """Translate a damaged model; return whether it was read."""
    text = damaged(rng.choice(MODELS), rng, lambda word: rng.choice(WORDS))
    replayed = recorded(folder, text)
    done = translate("model.tcl", replayed, lambda deck: {}, ("kN", "m", "s") if rng.random() < 0.5 else ())
    assert bool(done.text) != has_errors(done.report)
    for d in done.report:
        assert d.span and 1 <= d.span.line <= text.count("\n") + 2
    if done.text:
        _, mistakes, _ = read_text(done.text, CATALOG, name="new")
        assert all(d.span is None or d.span.file != "new" for d in done.moved(mistakes, "new"))
    assert [path.name for path in folder.iterdir()] == ["model.tcl"]
    return bool(done.text)


@pytest.mark.parametrize("seed", range(3))
def test_a_damaged_model_is_read_or_told(tmp_path, monkeypatch, seed):
    monkeypatch.chdir(tmp_path)
    rng = random.Random(seed)
    assert {check(tmp_path, rng) for _ in range(40)} == {True, False}
