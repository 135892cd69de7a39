"""Syntax definition of decks for Kate and KWrite."""

from __future__ import annotations

from typing import Final
from xml.etree import ElementTree as Xml

from highlighters.words import EXTENSIONS, words

#: style of the definition: what Kate calls it in its colour schemes
_STYLES: Final = {
    "Normal": "dsNormal",
    "Comment": "dsComment",
    "Text": "dsString",
    "Number": "dsFloat",
    "Operator": "dsOperator",
    "sections": "dsKeyword",
    "cards": "dsControlFlow",
    "kinds": "dsDataType",
    "members": "dsDataType",
    "items": "dsAttribute",
    "choices": "dsConstant",
    "functions": "dsFunction",
}


def text() -> str:
    """Return the file ``pound-deck.xml``."""
    w = words()
    head = {"name": "pound-solve deck", "section": "Scientific", "version": "1", "kateversion": "5.0"}
    files = {"extensions": ";".join(f"*.{e}" for e in EXTENSIONS), "casesensitive": "0", "priority": "5"}
    root = Xml.Element("language", {**head, **files})
    parts = Xml.SubElement(root, "highlighting")
    kinds = sorted({*w.elements, *w.kinds})
    lists = {
        "sections": w.sections,
        "cards": (*w.cards, "TO", "BY"),
        "kinds": kinds,
        "members": w.members,
        "items": w.items,
        "choices": w.choices,
        "functions": w.functions,
    }
    for name, some in lists.items():
        each = Xml.SubElement(parts, "list", {"name": name})
        for word in some:
            Xml.SubElement(each, "item").text = word
    context = Xml.SubElement(
        Xml.SubElement(parts, "contexts"),
        "context",
        {"name": "deck", "attribute": "Normal", "lineEndContext": "#stay"},
    )

    def rule(kind: str, style: str, **more: str) -> None:
        Xml.SubElement(context, kind, {"attribute": style, "context": "#stay", **more})

    rule("RegExpr", "Comment", String="!.*$")
    rule("RegExpr", "Text", String="\"[^\"]*\"|'[^']*'")
    rule("RegExpr", "items", String=rf"\b({'|'.join(w.items)})(?=\s*=)", insensitive="true")
    for name in ("sections", "cards", "kinds", "members", "functions", "choices"):
        rule("keyword", name, String=name)
    rule("RegExpr", "Number", String=r"\b[0-9]+\.?[0-9]*([ED][+-]?[0-9]+)?", insensitive="true")
    rule("AnyChar", "Operator", String="=,+-*/^()&")
    styles = Xml.SubElement(parts, "itemDatas")
    for name, colour in _STYLES.items():
        Xml.SubElement(styles, "itemData", {"name": name, "defStyleNum": colour})
    general = Xml.SubElement(root, "general")
    comments = Xml.SubElement(general, "comments")
    Xml.SubElement(comments, "comment", {"name": "singleLine", "start": "!"})
    Xml.SubElement(general, "keywords", {"casesensitive": "0"})
    Xml.indent(root, "  ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Xml.tostring(root, encoding="unicode") + "\n"
