"""The language server of ``pound-solve lsp``: connects the editor's protocol with `Project`."""

from __future__ import annotations

import asyncio
import logging
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from lsprotocol import types as lsp
from pygls import uris
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer

from pound_deck.diagnostics import Diagnostic
from pound_deck.layout import layout
from pound_deck.model import Span
from pound_solve.editor import complete, definition, hover, rename, symbols
from pound_solve.editor.project import Found, Project
from pound_solve.version import __version__

PAUSE: Final = 0.15  #: time without typing after which a deck is checked [s]

_SORTS: Final = {
    "section": lsp.CompletionItemKind.Module,
    "kind": lsp.CompletionItemKind.Class,
    "item": lsp.CompletionItemKind.Field,
    "word": lsp.CompletionItemKind.EnumMember,
    "name": lsp.CompletionItemKind.Variable,
    "function": lsp.CompletionItemKind.Function,
}
_SYMBOLS: Final = {
    "section": lsp.SymbolKind.Module,
    "card": lsp.SymbolKind.Property,
    "PARAM": lsp.SymbolKind.Variable,
    "line": lsp.SymbolKind.Field,
}


class DeckServer(LanguageServer):
    """A language server with the project of one editor."""

    def __init__(self, records: tuple[Path, ...] = ()) -> None:
        super().__init__("pound-solve", __version__)
        self.project = Project(records)
        self.edits: dict[str, int] = {}  # number of edits of a file: a check waits for the last one

    def open(self, uri: str) -> str:
        """Store the editor's text of a document in the project; return its path."""
        path = path_of(uri)
        self.project.put(path, self.workspace.get_text_document(uri).source)
        self.edits[path] = self.edits.get(path, 0) + 1
        return path

    def tell(self, mistakes: Found) -> None:
        """Send the mistakes of files, given by path, to the editor."""
        for path, diagnostics in mistakes.items():
            lines = self.lines(path)
            items = [self.diagnostic(d, lines) for d in diagnostics]
            uri = self.uri(path)
            self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, items))

    def uri(self, path: str) -> str:
        """URI of a file, that of the editor if the file is open."""
        known = (uri for uri in self.workspace.text_documents if path_of(uri) == path)
        return next(known, None) or uris.from_fs_path(path) or path

    def lines(self, path: str) -> list[str]:
        """Lines of a file in the project."""
        return self.project.text(path).split("\n")

    def diagnostic(self, d: Diagnostic, lines: Sequence[str]) -> lsp.Diagnostic:
        """A diagnostic of the protocol; one without a place gets the start of the deck."""
        error = d.severity == "error"
        return lsp.Diagnostic(
            range=self.range(d.span, lines)
            if d.span
            else lsp.Range(lsp.Position(0, 0), lsp.Position(0, 1)),
            message=d.message + (f"\nhint: {d.hint}" if d.hint else ""),
            severity=lsp.DiagnosticSeverity.Error if error else lsp.DiagnosticSeverity.Warning,
            code=d.code,
            source="pound-solve",
        )

    def range(self, span: Span, lines: Sequence[str], last: int | None = None) -> lsp.Range:
        """A span as a range of the protocol, up to the end of the line `last` if given."""
        codec = self.workspace.position_codec
        end = lsp.Position(span.line - 1, span.end - 1)
        if last is not None and last > span.line:
            end = lsp.Position(last - 1, len(lines[last - 1]) if last <= len(lines) else 0)
        range_ = lsp.Range(lsp.Position(span.line - 1, span.column - 1), end)
        return codec.range_to_client_units(lines, range_)

    def place(self, uri: str, position: lsp.Position) -> tuple[str, Span]:
        """Path of a document and the place of a position in it."""
        path = path_of(uri)
        reading = self.project.reading(path)
        name = next(iter(sorted(reading.files_at(path))), path)
        at = self.workspace.position_codec.position_from_client_units(self.lines(path), position)
        return path, Span(name, at.line + 1, at.character + 1, at.character + 2)

    def location(self, span: Span) -> lsp.Location:
        """A span as a place in a document."""
        path = os.path.realpath(span.file)
        return lsp.Location(self.uri(path), self.range(span, self.lines(path)))


def path_of(uri: str) -> str:
    """Real path of a document; an unsaved one has its name in the working folder."""
    path = uris.to_fs_path(uri)
    return os.path.realpath(path if path else os.path.basename(uri.partition(":")[2]) or "deck.inp")


def _is_fault(record: logging.LogRecord) -> bool:
    """Whether an entry of the log is other than a refused rename, which the editor shows itself."""
    return not (record.exc_info and isinstance(record.exc_info[1], JsonRpcException))


def server(records: tuple[Path, ...] = ()) -> DeckServer:
    """Return a server with all its features.

    Parameters
    ----------
    records : tuple of Path
        Folders searched for records, after that of the deck.
    """
    logging.getLogger("pygls.protocol.json_rpc").addFilter(_is_fault)
    deck_server = DeckServer(records)
    _documents(deck_server)
    _help(deck_server)
    _names(deck_server)
    return deck_server


def _documents(ls: DeckServer) -> None:
    """Add the features that send diagnostics when a document is opened, changed, saved or closed."""

    @ls.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
    def opened(params: lsp.DidOpenTextDocumentParams) -> None:
        ls.tell(ls.project.check(ls.open(params.text_document.uri)))

    @ls.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
    async def changed(params: lsp.DidChangeTextDocumentParams) -> None:
        path = ls.open(params.text_document.uri)
        edit = ls.edits[path]
        await asyncio.sleep(PAUSE)
        if ls.edits.get(path) == edit:
            ls.tell(ls.project.check(path))

    @ls.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
    def saved(params: lsp.DidSaveTextDocumentParams) -> None:
        ls.tell(ls.project.check(ls.open(params.text_document.uri)))

    @ls.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def closed(params: lsp.DidCloseTextDocumentParams) -> None:
        path = path_of(params.text_document.uri)
        ls.project.drop(path)
        ls.edits.pop(path, None)
        ls.tell({path: [], **ls.project.check(path)})


def _help(ls: DeckServer) -> None:
    """Add completion, hover, outline and layout."""

    @ls.feature(lsp.TEXT_DOCUMENT_COMPLETION, lsp.CompletionOptions(trigger_characters=["=", ","]))
    def completed(params: lsp.CompletionParams) -> lsp.CompletionList:
        path, at = ls.place(params.text_document.uri, params.position)
        reading = ls.project.reading(path)
        text = "\n".join(ls.lines(path))
        answer, start = complete.complete(reading, text, at.line, at.column)
        range_ = ls.range(Span(at.file, at.line, start, at.column), text.split("\n"))
        items = [
            lsp.CompletionItem(
                label=s.text,
                kind=_SORTS[s.sort],
                detail=s.detail,
                documentation=lsp.MarkupContent(lsp.MarkupKind.Markdown, s.more) if s.more else None,
                sort_text=f"{k:05d}",
                text_edit=lsp.TextEdit(range_, s.text),
            )
            for k, s in enumerate(answer)
        ]
        return lsp.CompletionList(is_incomplete=False, items=items)

    @ls.feature(lsp.TEXT_DOCUMENT_HOVER)
    def hovered(params: lsp.HoverParams) -> lsp.Hover | None:
        path, at = ls.place(params.text_document.uri, params.position)
        answer = hover.hover(ls.project.reading(path), at)
        if not answer:
            return None
        content = lsp.MarkupContent(lsp.MarkupKind.Markdown, answer[0])
        return lsp.Hover(content, ls.range(answer[1], ls.lines(path)))

    @ls.feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def outlined(params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
        path = path_of(params.text_document.uri)
        lines = ls.lines(path)

        def symbol(s: symbols.Symbol) -> lsp.DocumentSymbol:
            return lsp.DocumentSymbol(
                name=s.name,
                detail=s.detail,
                kind=_SYMBOLS[s.sort],
                range=ls.range(s.span, lines, s.last),
                selection_range=ls.range(s.span, lines),
                children=[symbol(b) for b in s.below],
            )

        return [symbol(s) for s in symbols.outline(ls.project.reading(path), path)]

    @ls.feature(lsp.TEXT_DOCUMENT_FORMATTING)
    def formatted(params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit] | None:
        path = path_of(params.text_document.uri)
        lines = ls.lines(path)
        new, _ = layout("\n".join(lines), path)
        if new is None:
            return None
        whole = lsp.Range(lsp.Position(0, 0), lsp.Position(len(lines), 0))
        return [lsp.TextEdit(whole, new)] if new != "\n".join(lines) else []


def _names(ls: DeckServer) -> None:
    """Add definition, references and rename."""

    @ls.feature(lsp.TEXT_DOCUMENT_DEFINITION)
    def defined(params: lsp.DefinitionParams) -> list[lsp.Location]:
        path, at = ls.place(params.text_document.uri, params.position)
        return [ls.location(span) for span in definition.define(ls.project.reading(path), at)]

    @ls.feature(lsp.TEXT_DOCUMENT_REFERENCES)
    def referred(params: lsp.ReferenceParams) -> list[lsp.Location]:
        path, at = ls.place(params.text_document.uri, params.position)
        return [ls.location(span) for span in definition.references(ls.project.reading(path), at)]

    @ls.feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
    def renamable(params: lsp.PrepareRenameParams) -> lsp.Range | None:
        path, at = ls.place(params.text_document.uri, params.position)
        span = rename.renamable(ls.project.reading(path), at)
        return ls.range(span, ls.lines(path)) if span else None

    @ls.feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
    def renamed(params: lsp.RenameParams) -> lsp.WorkspaceEdit:
        path, at = ls.place(params.text_document.uri, params.position)
        deck = ls.project.deck(path)
        try:
            edits = rename.rename(ls.project.reading(path), deck, at, params.new_name)
        except rename.RenameError as error:
            raise JsonRpcException(str(error), lsp.LSPErrorCodes.RequestFailed) from None
        changes: dict[str, list[lsp.TextEdit]] = {}
        for span, text in edits:
            there = ls.location(span)
            changes.setdefault(there.uri, []).append(lsp.TextEdit(there.range, text))
        return lsp.WorkspaceEdit(changes=changes)
