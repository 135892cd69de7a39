"""From the text of an old deck to a deck of this program."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from pound_deck.diagnostics import Diagnostic, Mistake, has_errors
from pound_deck.model import Span
from pound_deck.schema import Catalog
from pound_import.draft import Draft
from pound_import.ruaumoko import analysis, elements, header, nodal, nodes, props
from pound_import.ruaumoko.equake import File
from pound_import.ruaumoko.header import Control
from pound_import.ruaumoko.lines import DataLine, DataLines, row
from pound_import.ruaumoko.recognise import control_lines, in_space
from pound_import.translation import Translation, written

#: heads of sections
_HEADS: Final = ("NODES", "DRIFT", "ELEMENTS", "PROPS", "WEIGHTS", "LOADS", "SHAPE", "DAMPING", "EQUAKE")
_NEEDED: Final = ("NODES", "ELEMENTS", "PROPS")
_RUN: Final = (
    "pound-solve import DECK -o model.inp marks it in a deck of this program; check it there, and run that"
)
_CHECK: Final = "compare it with your manual of Ruaumoko or a listing of the deck"
_MOST_LINES: Final = 200_000  #: before the record


def translate(
    name: str, text: str, catalog: Catalog, records: Sequence[File] = (), shown: str = "", run: bool = False
) -> Translation:
    """Read an old deck.

    Parameters
    ----------
    name : str
        Of its file, for the places of messages.
    text : str
    catalog : Catalog
        Source of the available hysteresis rules.
    records : sequence of File
        Files of records that do not follow in the deck: horizontal, vertical.
    shown : str
        Name of the old deck, which holds the record, in the new deck.
    run : bool
        The new deck is run at once: readings by convention are errors.

    Returns
    -------
    Translation
    """
    draft = Draft(_CHECK)
    lines = text.splitlines()
    try:
        sections, control = _outline(name, text, lines, draft)
    except Mistake as error:
        return Translation("", (), tuple([error.diagnostic] if error.diagnostic else []))
    _translate(sections, control, (File(shown or name, text), list(records)), catalog, draft)
    if run:
        draft.report[:] = [
            replace(d, severity="error", hint=_RUN) if d.code in ("L605", "L609") else d
            for d in draft.report
        ]
    draft.report.append(_ground(draft, Span(name, 1, 1, 2)))
    draft.report.sort(key=lambda d: (d.span.line, d.span.column) if d.span else (0, 0))
    if has_errors(draft.report):
        return Translation("", (), tuple(draft.report))
    title = lines[0].strip() if lines else ""
    source = f"Read from the Ruaumoko-2D deck {name}."
    return written(title, source, draft)


@dataclass(frozen=True, slots=True)
class _SectionLines:
    """A section's head and its lines; the record behind EQUAKE is not among them."""

    head: DataLine
    rows: DataLines


def _outline(
    name: str, text: str, lines: list[str], draft: Draft
) -> tuple[Mapping[str, _SectionLines], Control]:
    """Sections of the deck by name, and the values of its control lines.

    Raises
    ------
    Mistake
        The text is no such deck, a 3-D deck, or its control lines are incomplete.
    """
    here = Span(name, 1, 1, 2)
    first = control_lines(text)
    if not first:
        raise Mistake(
            Diagnostic("L610", f"{name} is no deck of Ruaumoko-2D", here, "it has no control lines")
        )
    if in_space(first):
        what = "this is a deck of Ruaumoko-3D; this program reads plane structures only"
        raise Mistake(Diagnostic("L601", what, here, "model one of its frames as a plane deck"))
    begins: list[DataLine] = []
    sections: dict[str, _SectionLines] = {}
    current: list[DataLine] | None = None
    for number, raw in enumerate(lines[1:_MOST_LINES], 2):
        line = row(name, number, raw)
        if line is None:
            continue
        if line.word in _HEADS:
            if line.word in sections:
                what = f"{line.word} is given twice"
                draft.report.append(Diagnostic("L607", what, line.span, "join the two"))
            sections[line.word] = _SectionLines(line, DataLines([], line.span))
            current = sections[line.word].rows.rows
        elif current is None:
            begins.append(line)
        else:
            current.append(line)
            if "EQUAKE" in sections and len(current) == 2:
                break
    for missing in (w for w in _NEEDED if w not in sections):
        draft.report.append(Diagnostic("L607", f"there is no section {missing}", here, "add it"))
    return sections, header.read(begins, here)


def _translate(
    sections: Mapping[str, _SectionLines],
    control: Control,
    files: tuple[File, list[File]],
    catalog: Catalog,
    draft: Draft,
) -> None:
    """Fill the draft, section by section."""

    def attempt(step: Callable[[], object]) -> None:
        with draft.keeping():
            step()

    attempt(lambda: header.write(control, draft))
    points = {}
    if "NODES" in sections:
        points = nodes.read(sections["NODES"].rows, control.whole("NNP"), draft)
        nodes.write(points, draft)
    if "DRIFT" in sections:
        levels = control.whole("NLEVEL"), control.place("NLEVEL")
        nodes.drifts(sections["DRIFT"].rows, *levels, points, draft)
    members = {}
    if "ELEMENTS" in sections:
        counts = control.whole("NMEM"), control.whole("NTYPE")
        members = elements.read(sections["ELEMENTS"].rows, *counts, points, draft)
        elements.write(members, draft)
    if "PROPS" in sections:
        elastic = not control.whole("IPLAS")
        rows = sections["PROPS"].rows
        props.read(rows, control.whole("NTYPE"), members, points, elastic, catalog, draft)
    if "WEIGHTS" in sections:
        head = sections["WEIGHTS"].head
        option = head.items[1] if len(head.items) > 1 else None
        attempt(lambda: nodal.weights(sections["WEIGHTS"].rows, option, control["GRAV"], points, draft))
    loaded = "LOADS" in sections and nodal.loads(sections["LOADS"].rows, points, draft)
    if "DAMPING" in sections:
        draft.add(
            "DAMPING",
            "",
            sections["DAMPING"].head.span,
            [draft.lose(sections["DAMPING"].head.span, "DAMPING")],
        )
    attempt(lambda: analysis.damping(control, draft))
    attempt(lambda: analysis.runs(control, loaded, draft))
    attempt(lambda: _excite(sections, control, files, points, draft))


def _excite(
    sections: Mapping[str, _SectionLines],
    control: Control,
    files: tuple[File, list[File]],
    points: dict[int, nodes.LegacyNode],
    draft: Draft,
) -> None:
    """Add ground motions or forces in time."""
    code = analysis.kind(control)
    if code not in (analysis.EARTHQUAKE, analysis.FORCES):
        return
    if "EQUAKE" not in sections:
        what = "a history without a section EQUAKE"
        draft.report.append(Diagnostic("L607", what, control.place("IPANAL"), "add it"))
        return
    rows = sections["EQUAKE"].rows
    if code == analysis.EARTHQUAKE:
        analysis.motions(rows, control, *files, draft)
        return
    shape = nodal.shape(sections["SHAPE"].rows, points, draft) if "SHAPE" in sections else []
    if not shape:
        what = "a force history without a SHAPE"
        draft.report.append(Diagnostic("L607", what, control.place("IPANAL"), "add the section SHAPE"))
    analysis.forces(rows, control, shape, *files, draft)


def _ground(draft: Draft, here: Span) -> Diagnostic:
    """Warning that states the evidence for how the deck was read."""
    text = "read as a deck of Ruaumoko-2D: but for what is marked, as one whose results are known"
    if draft.evidence:
        text += "; by decks of others: " + "; ".join(draft.evidence)
    return Diagnostic("L606", text, here, "the page Coming from Ruaumoko says what is known", "warning")
