"""User-defined language of decks for Notepad++."""

from __future__ import annotations

from typing import Final
from xml.etree import ElementTree as Xml

from highlighters.words import words

#: keyword lists in the order of Notepad++, and those that it needs although they are empty
_OPERATORS: Final = "= , ( ) + - * / ^ &"
_EMPTY: Final = (
    *(
        f"Numbers, {part}"
        for part in ("prefix1", "prefix2", "extras1", "extras2", "suffix1", "suffix2", "range")
    ),
    "Operators2",
    *(
        f"Folders in {code}, {part}"
        for code in ("code1", "code2", "comment")
        for part in ("open", "middle", "close")
    ),
)
#: style: colour, bold
_STYLES: Final = {
    "DEFAULT": ("000000", 0),
    "COMMENTS": ("008000", 0),
    "LINE COMMENTS": ("008000", 0),
    "NUMBERS": ("B05000", 0),
    "KEYWORDS1": ("0000C0", 1),
    "KEYWORDS2": ("800080", 1),
    "KEYWORDS3": ("005080", 0),
    "KEYWORDS4": ("800080", 0),
    "KEYWORDS5": ("A04000", 0),
    "KEYWORDS6": ("505000", 0),
    "KEYWORDS7": ("0000C0", 0),
    "KEYWORDS8": ("000000", 0),
    "OPERATORS": ("606060", 0),
    "FOLDER IN CODE1": ("000000", 0),
    "FOLDER IN CODE2": ("000000", 0),
    "FOLDER IN COMMENT": ("000000", 0),
    "DELIMITERS1": ("A00000", 0),
    "DELIMITERS2": ("A00000", 0),
    **{f"DELIMITERS{k}": ("000000", 0) for k in range(3, 9)},
}


def text() -> str:
    """Return the file ``pound-deck.udl.xml``."""
    root = Xml.Element("NotepadPlus")
    attributes = {"name": "pound-solve deck", "ext": "inp inc", "udlVersion": "2.1"}
    language = Xml.SubElement(root, "UserLang", attributes)
    settings = Xml.SubElement(language, "Settings")
    no = {"allowFoldOfComments": "no", "foldCompact": "no", "forcePureLC": "0", "decimalSeparator": "0"}
    Xml.SubElement(settings, "Global", {"caseIgnored": "yes", **no})
    Xml.SubElement(settings, "Prefix", {f"Keywords{k}": "no" for k in range(1, 9)})
    lists = Xml.SubElement(language, "KeywordLists")
    for name, content in _lists().items():
        Xml.SubElement(lists, "Keywords", {"name": name}).text = content
    styles = Xml.SubElement(language, "Styles")
    for name, (colour, bold) in _STYLES.items():
        look = {"fgColor": colour, "bgColor": "FFFFFF", "fontStyle": str(bold), "nesting": "0"}
        Xml.SubElement(styles, "WordsStyle", {"name": name, **look})
    Xml.indent(root, "    ")
    return '<?xml version="1.0" encoding="UTF-8" ?>\n' + Xml.tostring(root, encoding="unicode") + "\n"


def _lists() -> dict[str, str]:
    w = words()
    groups = (
        w.sections,
        {*w.elements, *w.kinds},
        w.items,
        w.members,
        w.choices,
        w.functions,
        w.cards,
        ("TO", "BY"),
    )
    delimiters = "00\" 01 02((\" EOL)) 03' 04 05((' EOL)) " + " ".join(f"{k:02d}" for k in range(6, 24))
    return {
        "Comments": "00! 01 02 03 04",
        "Operators1": _OPERATORS,
        **dict.fromkeys(_EMPTY, ""),
        **{f"Keywords{k}": " ".join(sorted(group)) for k, group in enumerate(groups, 1)},
        "Delimiters": delimiters,
    }
