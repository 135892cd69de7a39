"""The server as an editor meets it: a client starts ``pound-solve lsp`` and speaks with it over pipes."""

import asyncio
import json
import os
import sys
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

pytest.importorskip("pygls")

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from pygls.lsp.client import BaseLanguageClient

from pound_deck.layout import layout
from pound_solve.cli.main import main
from tiers import at_night

ROOT = Path(__file__).parents[2]
DECK = """TITLE  Masse 𝄞 auf Feder
PARAM  k = 4000
NODES
   1  0 0  FIX=XYR
INCLUDE "more.inc"
ELEMENTS
   1  COLUMN 1 2
PROPS
   COLUMN SPRING KX=k KY=10
WEIGHTS
   2 981
INITIAL
   2 VX=1
ANALYSIS
   HISTORY 1
"""
MORE = "   2  3 0  FIX=YR\n"


class Editor(BaseLanguageClient):
    """An editor that keeps what it is told of each file."""

    def __init__(self):
        super().__init__("test", "1")
        self.told = asyncio.Queue()

    async def diagnostics(self, uri):
        """The next message on a file: (line, column, end, code) of each mistake, from 1."""
        while True:
            p = await asyncio.wait_for(self.told.get(), 60)
            if p.uri == uri:
                return [
                    (d.range.start.line + 1, d.range.start.character + 1, d.range.end.character + 1, d.code)
                    for d in p.diagnostics
                ]

    def opened(self, path, text):
        document = lsp.TextDocumentItem(path.as_uri(), "pound-deck", 1, text)
        self.text_document_did_open(lsp.DidOpenTextDocumentParams(document))
        return path.as_uri()

    def typed(self, uri, version, line, column, text, until=None):
        start = lsp.Position(line - 1, column - 1)
        end = lsp.Position(line - 1, (until or column) - 1)
        change = lsp.TextDocumentContentChangePartial(range=lsp.Range(start, end), text=text)
        document = lsp.VersionedTextDocumentIdentifier(version, uri)
        self.text_document_did_change(lsp.DidChangeTextDocumentParams(document, [change]))

    @staticmethod
    def at(uri, line, column):
        return {
            "text_document": lsp.TextDocumentIdentifier(uri),
            "position": lsp.Position(line - 1, column - 1),
        }


@asynccontextmanager
async def editor(units=None):
    """A started editor; the server must end by itself, with nothing on its error stream."""
    client = Editor()

    @client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
    def told(params):
        client.told.put_nowait(params)

    env = os.environ | {"POUND_COMPILE": "0"}
    await client.start_io(sys.executable, "-m", "pound_solve", "lsp", env=env, cwd=ROOT)
    general = lsp.GeneralClientCapabilities(position_encodings=units) if units else None
    capabilities = lsp.ClientCapabilities(general=general)
    await asyncio.wait_for(client.initialize_async(lsp.InitializeParams(capabilities=capabilities)), 60)
    client.initialized(lsp.InitializedParams())
    yield client
    await client.shutdown_async(None)
    client.exit(None)
    assert await asyncio.wait_for(client._server.wait(), 60) == 0
    assert await client._server.stderr.read() == b""
    await client.stop()


@pytest.fixture(scope="module")
def speak():
    """Carries out sessions with one editor and one server for all: a start takes a second."""
    with asyncio.Runner() as runner:
        started = editor()
        shared = runner.run(started.__aenter__())
        yield lambda session: runner.run(session(shared))
        runner.run(started.__aexit__(None, None, None))


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "deck.inp").write_text(DECK, encoding="utf-8")
    (tmp_path / "more.inc").write_text(MORE)
    return tmp_path.resolve()


@pytest.mark.full
def test_mistakes_are_told_as_one_types(speak, folder):
    async def session(e):
        uri = e.opened(folder / "deck.inp", DECK)
        assert await e.diagnostics(uri) == []
        e.typed(uri, 2, 9, 21, "k")  # KX=kk
        assert await e.diagnostics(uri) == [(9, 21, 23, "P222")]
        e.typed(uri, 3, 2, 9, "k")  # PARAM kk: what the deck says now, not what is on the disk
        assert await e.diagnostics(uri) == []
        e.typed(uri, 4, 9, 29, " (")
        assert [d[3] for d in await e.diagnostics(uri)] == ["P203"]
        assert (folder / "deck.inp").read_text("utf-8") == DECK

    speak(session)


def test_the_last_of_many_edits_is_checked(speak, folder):
    async def session(e):
        uri = e.opened(folder / "deck.inp", DECK)
        await e.diagnostics(uri)
        for k in range(10):
            e.typed(uri, 2 + k, 9, 22 + k, "x")
        assert await e.diagnostics(uri) == [(9, 21, 32, "P222")]
        assert all(e.told.get_nowait().uri != uri for _ in range(e.told.qsize()))

    speak(session)


def test_an_included_file_is_checked_as_part_of_its_deck(speak, folder):
    async def session(e):
        uri = e.opened(folder / "deck.inp", DECK)
        assert await e.diagnostics(uri) == []
        more = e.opened(folder / "more.inc", MORE)
        assert await e.diagnostics(more) == []
        e.typed(more, 2, 1, 4, "3", until=5)  # node 3 in place of node 2
        assert [d[3] for d in await e.diagnostics(uri)] == ["P305"] * 3
        assert [d[3] for d in await e.diagnostics(more)] == ["P314"]
        e.typed(more, 3, 1, 4, "2", until=5)
        assert await e.diagnostics(uri) == [] and await e.diagnostics(more) == []
        for name, column in ((uri, 16), (more, 4)):  # J of the element, and the node itself
            at = e.at(name, 7 if name == uri else 1, column)
            places = await e.text_document_definition_async(lsp.DefinitionParams(**at))
            assert [(p.uri, p.range.start.character) for p in places] == [(more, 3)]

    speak(session)


def test_an_included_file_that_is_opened_alone_finds_its_deck(speak, folder):
    async def session(e):
        more = e.opened(folder / "more.inc", MORE + "   9  9 0\n")
        assert await e.diagnostics(more) == [(2, 4, 10, "P314")]

    speak(session)


def test_a_closed_file_has_no_mistakes_any_more(speak, folder):
    async def session(e):
        uri = e.opened(folder / "deck.inp", DECK + "oops (\n")
        assert len(await e.diagnostics(uri)) == 1
        e.text_document_did_close(lsp.DidCloseTextDocumentParams(lsp.TextDocumentIdentifier(uri)))
        assert await e.diagnostics(uri) == []

    speak(session)


def test_mistakes_of_records_and_of_the_structure_are_those_of_check(speak, folder, capsys):
    bad = DECK.replace("ANALYSIS", 'EQUAKE\n   RECORD "none.at2"\nANALYSIS').replace("KY=10", "FX=10 KY=0")

    async def session(e):
        return await e.diagnostics(e.opened(folder / "deck.inp", bad))

    told = speak(session)
    (folder / "deck.inp").write_text(bad, encoding="utf-8")
    assert main(["check", str(folder / "deck.inp"), "--json"]) == 2
    found = json.loads(capsys.readouterr().out)["diagnostics"]
    assert [(d["line"], d["number"]) for d in found] == [(line, code) for line, _, _, code in told]
    assert {d["number"][0] for d in found} >= {"R"}


def test_every_kind_of_help_once(speak, folder):
    async def session(e):
        uri = e.opened(folder / "deck.inp", DECK)
        await e.diagnostics(uri)
        found = await e.text_document_completion_async(lsp.CompletionParams(**e.at(uri, 9, 21)))
        assert {"k", "sqrt"} <= {item.label for item in found.items}
        edit = next(item.text_edit for item in found.items if item.label == "k")
        assert (edit.range.start.character, edit.range.end.character) == (20, 20)
        help_ = await e.text_document_hover_async(lsp.HoverParams(**e.at(uri, 9, 18)))
        assert "**KX** [kN/m]" in help_.contents.value and help_.range.start.character == 17
        document = lsp.TextDocumentIdentifier(uri)
        symbols = await e.text_document_document_symbol_async(lsp.DocumentSymbolParams(document))
        assert [s.name for s in symbols][:3] == ["TITLE", "K", "NODES"]
        assert [c.name for c in symbols[4].children] == ["COLUMN"]
        assert all(s.range.end.line >= s.selection_range.end.line for s in symbols)
        places = await e.text_document_definition_async(lsp.DefinitionParams(**e.at(uri, 9, 21)))
        assert [(p.uri, p.range.start.line, p.range.start.character) for p in places] == [(uri, 1, 7)]
        context = lsp.ReferenceContext(include_declaration=True)
        where = e.at(uri, 7, 8)
        places = await e.text_document_references_async(lsp.ReferenceParams(context=context, **where))
        assert [p.range.start.line + 1 for p in places] == [7, 9]
        name = await e.text_document_prepare_rename_async(lsp.PrepareRenameParams(**where))
        assert (name.start.character, name.end.character) == (6, 12)
        renamed = await e.text_document_rename_async(lsp.RenameParams(new_name="POST", **where))
        edits = [(x.range.start.line + 1, x.new_text) for x in renamed.changes[uri]]
        assert edits == [(7, "POST"), (9, "POST")]
        with pytest.raises(JsonRpcException, match="is no name"):
            await e.text_document_rename_async(lsp.RenameParams(new_name="a'b", **where))
        options = lsp.FormattingOptions(tab_size=3, insert_spaces=True)
        (new,) = await e.text_document_formatting_async(lsp.DocumentFormattingParams(document, options))
        assert new.new_text == layout(DECK)[0]

    speak(session)


def test_a_node_is_renamed_in_the_included_file_too(speak, folder):
    async def session(e):
        uri = e.opened(folder / "deck.inp", DECK)
        await e.diagnostics(uri)
        where = e.at(uri, 7, 16)
        found = await e.text_document_rename_async(lsp.RenameParams(new_name="20", **where))
        lines = {
            Path(u).name: [x.range.start.line + 1 for x in edits] for u, edits in found.changes.items()
        }
        assert lines == {"more.inc": [1], "deck.inp": [7, 11, 13]}

    speak(session)


@pytest.mark.full
@pytest.mark.parametrize(
    "units", [[lsp.PositionEncodingKind.Utf8], *at_night(None, [lsp.PositionEncodingKind.Utf32])]
)
def test_columns_are_in_the_units_of_the_editor(folder, units):
    """A clef is one character, two units of UTF-16, four of UTF-8."""
    text = DECK.replace('INCLUDE "more.inc"\n', MORE).replace("NAME", "") + 'DRIFT\n "𝄞𝄞" 1 7\n'
    encoding = {None: "utf-16-le", "utf-32": "utf-32-le", "utf-8": "utf-8"}[
        units[0].value if units else None
    ]
    width = {"utf-16-le": 2, "utf-32-le": 4, "utf-8": 1}[encoding]
    column = len(' "𝄞𝄞" 1 '.encode(encoding)) // width

    async def session():
        async with editor(units) as e:
            uri = e.opened(folder / "deck.inp", text)
            assert [d[1:] for d in await e.diagnostics(uri)] == [(column + 1, column + 2, "P305")]
            line = text.count("\n")
            places = await e.text_document_hover_async(lsp.HoverParams(**e.at(uri, line, column + 1)))
            assert "**J**" in places.contents.value and places.range.start.character == column

    asyncio.run(session())


def test_half_a_deck_stops_no_help(speak, folder):
    async def session(e):
        uri = e.opened(folder / "deck.inp", "")
        typed = DECK.split("WEIGHTS")[0] + 'WEIGHTS\n  2 (1+\n "'
        line = column = 1
        for version, letter in enumerate(typed, 2):
            e.typed(uri, version, line, column, letter)
            line, column = (
                (line + 1, 1) if letter == "\n" else (line, column + len(letter.encode("utf-16-le")) // 2)
            )
        where = e.at(uri, line, column)
        await e.text_document_completion_async(lsp.CompletionParams(**where))
        await e.text_document_hover_async(lsp.HoverParams(**where))
        await e.text_document_definition_async(lsp.DefinitionParams(**where))
        with pytest.raises(JsonRpcException, match="mistake of syntax"):
            await e.text_document_rename_async(lsp.RenameParams(new_name="x", **where))
        while not {"P203", "P202"} <= {d[3] for d in await e.diagnostics(uri)}:
            pass  # the queue's own limit of time ends this

    speak(session)


def test_without_the_extra_a_line_says_how_to_install_it(monkeypatch, capsys):
    for name in [
        n for n in sys.modules if n.startswith(("pygls", "lsprotocol", "pound_solve.editor.server"))
    ]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "lsprotocol", None)  # as if it were not there
    assert main(["lsp"]) == 2
    assert capsys.readouterr().err == 'pound-solve: lsp needs pygls: pip install "pound-solve[lsp]"\n'
