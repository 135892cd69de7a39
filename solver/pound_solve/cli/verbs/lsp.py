"""``pound-solve lsp``: help an editor, which starts this verb itself."""

from __future__ import annotations

import argparse
from pathlib import Path

from pound_solve.cli import common

SUMMARY = "start the language server, for editors (see manual/editor.md)"
EXAMPLES = (("", "started by the editor"),)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "--records", action="append", default=[], type=Path, metavar="DIR", help="folder with records"
    )
    parser.add_argument("--stdio", action="store_true", help="accepted, as some editors add it")


def execute(args: argparse.Namespace) -> int:
    """Answer the editor on standard input and output until it ends the server."""
    try:
        from pound_solve.editor.server import server
    except ModuleNotFoundError as err:
        if err.name not in ("pygls", "lsprotocol"):
            raise
        return common.complain('lsp needs pygls: pip install "pound-solve[lsp]"', common.MISTAKES)
    server(tuple(args.records)).start_io()
    return common.DONE
