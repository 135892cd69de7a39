"""Parameters of hysteresis rules, in the order of the old deck, for those whose order is known or recalled.

Rule 52 occurs in a deck with known results.  The orders of all others are recalled.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

from pound_deck.schema import Catalog, Spec
from pound_import.draft import Draft, number, numbers
from pound_import.ruaumoko.lines import DataItem, DataLine, DataLines

Values = dict[str, float]


class RuleLayout(NamedTuple):
    """Items of a rule's lines, and their conversion to the new deck.

    `write` converts the values, including the post-yield ratio R, to items of the new deck; `losses` names
    values without a counterpart, each with the value for which nothing is lost.
    """

    lines: tuple[tuple[str, ...], ...]
    write: Callable[[Values], str]
    losses: tuple[tuple[str, float], ...] = ()


def _ratio(v: Values) -> str:
    return f"R={number(v['R'])}"


def _nothing(v: Values) -> str:
    return ""


def _alfa(v: Values) -> str:
    return f"R={number(v['R'])} ALFA={number(v['ALFA'])}"


def _ramberg_osgood(v: Values) -> str:
    return f"N={number(v['R-exponent'])}"


def _alfa_beta(v: Values) -> str:
    return f"{_alfa(v)} BETA={number(v['BETA'])}"


def _slack(v: Values) -> str:
    grow = "" if v["IMODE"] == 0 else " GROW=NO"
    return f"R={number(v['R'])} SLACK={numbers((v['GAP+'], v['GAP-']))}{grow}"


def _stewart(v: Values) -> str:
    items = {"PTRI": v["PTRI"], "PUNL": v["PUNL"], "BETA": v["BETA"], "ALPHA": v["ALPHA"]}
    text = " ".join(f"{name}={number(x)}" for name, x in items.items())
    return (
        f"R={number(v['R'])} FU={number(v['FU'])} FI={number(v['FI'])} "
        f"SLACK={numbers((v['GAP+'], v['GAP-']))} {text}"
    )


def _schoettler(v: Values) -> str:
    pairs = {"FCR": ("Fcr+", "Fcr-"), "RHO": ("Rho+", "Rho-"), "DULT": ("Dult+", "Dult-")}
    text = " ".join(f"{name}={number(v[a])},{number(v[b])}" for name, (a, b) in pairs.items())
    return f"R={number(v['R'])} {text} ALFA={number(v['ALFA'])} PINCH={number(v['PINCH'])}"


LAYOUTS: Final = {
    0: RuleLayout((), _nothing),
    1: RuleLayout((), _nothing),
    2: RuleLayout((), _ratio),
    3: RuleLayout((("R-exponent",),), _ramberg_osgood),
    4: RuleLayout((("ALFA", "BETA", "NF", "KKK"),), _alfa_beta, (("NF", 1.0), ("KKK", 1.0))),
    5: RuleLayout((("GAP+", "GAP-", "IMODE"),), _slack),
    7: RuleLayout((), _ratio),
    9: RuleLayout(
        (("FU", "FI", "PTRI", "PUNL", "GAP+", "GAP-", "BETA", "ALPHA", "LOOP"),), _stewart, (("LOOP", 0.0),)
    ),
    10: RuleLayout((("ALFA",),), _alfa),
    11: RuleLayout((("ALFA",),), _alfa),
    12: RuleLayout((("ALFA",),), _alfa),
    28: RuleLayout((("ALFA", "BETA"),), _alfa_beta),
    52: RuleLayout(
        (
            ("Kneg", "Rbeg", "Fcr+", "Fcr-", "Rho+", "Rho-", "Dult+", "Dult-", "IOP"),
            ("ALFA", "BETA", "PINCH", "KAPPA+", "FRESID", "DFACTOR"),
        ),
        _schoettler,
        (("Kneg", 1.0), ("IOP", 0.0), ("BETA", 0.0), ("DFACTOR", 0.0)),
    ),
}
CERTAIN: Final = (0, 1, 2, 7, 52)  #: rules without parameters, and the one of a deck with known results


def known(code: int, item: DataItem, catalog: Catalog) -> Spec:
    """Spec of the rule of a code, IHYST, that can be carried over.

    Raises
    ------
    Mistake
        The order of its parameters is not known, or this program does not have it.
    """
    spec = catalog.by_code("hysteresis", code)
    if spec is None or code not in LAYOUTS:
        have = ", ".join(str(c) for c in sorted(LAYOUTS) if catalog.by_code("hysteresis", c))
        what = f"is {code}, a rule that is not carried over"
        raise item.mistake("L604", "IHYST", what, f"rules that are: {have}")
    return spec


def read(code: int, rows: DataLines, ratio: float, draft: Draft, notes: list[str]) -> str:
    """Read the next set of lines of a rule; return its items in the new deck.

    Raises
    ------
    Mistake
        A line is missing or holds something else.
    """
    layout, values = LAYOUTS[code], {"R": ratio}
    first: DataLine | None = None
    for names in layout.lines:
        row = rows.next(f"the parameters of rule {code}: {' '.join(names)}")
        first = first or row
        values |= zip(names, row.reals(names, 1))
    if first is not None:
        if code not in CERTAIN:
            order = " ".join(" ".join(names) for names in layout.lines)
            notes.append(draft.doubt(first.span, f"rule {code} has the parameters {order}"))
        for name, usual in layout.losses:
            if values[name] != usual:
                what = f"{name} {number(values[name])} of rule {code} (what it does is not known)"
                notes.append(draft.lose(first.span, what))
        if code == 52 and values["Rbeg"] != ratio:
            notes.append(draft.lose(first.span, f"Rbeg {number(values['Rbeg'])} beside RF {number(ratio)}"))
    return layout.write(values)
