"""Load patterns, and the static loads that the user chooses: patterns, a case or a combination."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import mistake
from pound_deck.model import Span
from pound_import.draft import Draft
from pound_import.sap2000.tables import MOST, SapRow, SapTables

STATIC: Final = ("LINSTATIC", "NONSTATIC")  #: types of cases
_DEEPEST: Final = 8  #: combinations of combinations


@dataclass(frozen=True, slots=True)
class StaticLoad:
    """Chosen static loads.

    Attributes
    ----------
    label : str
        For messages; empty without loads.
    factors : dict of str to float
        By pattern.
    case : str
        The case, where one is chosen.
    """

    label: str
    factors: Mapping[str, float]
    span: Span
    case: str = ""


def patterns(tables: SapTables, draft: Draft) -> dict[str, float]:
    """Factors of the weight of members in each load pattern."""
    out: dict[str, float] = {}
    for row in tables["LOAD PATTERN DEFINITIONS"]:
        with draft.keeping():
            out[row.text("LoadPat")] = row.real("SelfWtMult", 0.0)
    return out


def cases(tables: SapTables, draft: Draft) -> dict[str, SapRow]:
    """Cases that are run, by name."""
    out: dict[str, SapRow] = {}
    for row in tables["LOAD CASE DEFINITIONS"]:
        with draft.keeping():
            if row.yes("RunCase", True):
                out[row.text("Case")] = row
    return out


def choose(
    tables: SapTables, known: Mapping[str, float], run: Mapping[str, SapRow], wanted: str, draft: Draft
) -> StaticLoad:
    """Choose the static loads.

    Parameters
    ----------
    tables : SapTables
    known : mapping of str to float
        Patterns.
    run : mapping of str to SapRow
        Cases that are run.
    wanted : str
        A case, a combination, or patterns separated by commas; empty: the only static case or pattern, or
        none where there are several.
    draft : Draft

    Raises
    ------
    Mistake
        There is no such case, combination or pattern.
    """
    if not wanted.strip():
        assigned = _assigned(tables)
        static = [x for x, row in run.items() if row.word("Type") in STATIC and x in assigned]
        names = static or list(known)
        if len(names) == 1:
            return _load(tables, known, names[0], tables.here)
        if names:
            what = f"static loads: none of {', '.join(n[:40] for n in names[:20])} is chosen"
            draft.add("LOADS", "", tables.here, [draft.lose(tables.here, what, "--load with one of them")])
        return StaticLoad("", {}, tables.here)
    return _load(tables, known, wanted.strip(), tables.here)


def _load(tables: SapTables, known: Mapping[str, float], wanted: str, here: Span) -> StaticLoad:
    assigned, combined = _assigned(tables), _combined(tables)
    same = _by_capitals((*assigned, *combined))
    if wanted.upper() in same:
        case = same[wanted.upper()]
        return StaticLoad(case, _sum(case, assigned, combined, known, 0), here, case)
    parts = [part.strip() for part in wanted.split(",") if part.strip()]
    spelt = _by_capitals(known)
    missing = [part for part in parts if part.upper() not in spelt]
    if missing or not parts:
        what = f"no static case, combination or load pattern is called {', '.join(missing)[:80] or 'so'}"
        names = list(dict.fromkeys([*assigned, *combined, *known]))
        raise mistake("L649", what, here, f"there are {', '.join(n[:40] for n in names[:20]) or 'none'}")
    return StaticLoad(wanted, {spelt[part.upper()]: 1.0 for part in parts}, here)


def _by_capitals(names: tuple[str, ...] | Mapping[str, float]) -> dict[str, str]:
    return {name.upper(): name for name in names}


def _assigned(tables: SapTables) -> dict[str, list[SapRow]]:
    """Rows of the loads of static cases."""
    out: dict[str, list[SapRow]] = {}
    for row in tables["CASE - STATIC 1 - LOAD ASSIGNMENTS"]:
        out.setdefault(row.text("Case"), []).append(row)
    return out


def _combined(tables: SapTables) -> dict[str, list[SapRow]]:
    """Rows of the combinations."""
    out: dict[str, list[SapRow]] = {}
    for row in tables["COMBINATION DEFINITIONS"]:
        out.setdefault(row.text("ComboName"), []).append(row)
    return out


def _sum(
    name: str,
    assigned: Mapping[str, list[SapRow]],
    combined: Mapping[str, list[SapRow]],
    known: Mapping[str, float],
    depth: int,
) -> dict[str, float]:
    """Factors of patterns in a case or a combination.

    Raises
    ------
    Mistake
        It holds something else than load patterns, is an envelope or contains itself.
    """
    total: dict[str, float] = {}
    is_case = name in assigned
    for row in assigned[name] if is_case else combined.get(name, []):
        part = row.text("LoadName" if is_case else "CaseName")
        factor = row.real("LoadSF" if is_case else "ScaleFactor", 1.0)
        inner = {part: 1.0}
        if is_case and (row.word("LoadType", "LOAD PATTERN") != "LOAD PATTERN" or part not in known):
            what = f"case {name[:40]} has a load that is no load pattern: {part[:40]}"
            raise mistake("L651", what, row.span, "--load with load patterns")
        if not is_case:
            linear = row.word("ComboType", "LINEAR ADD") == "LINEAR ADD"
            if not linear or depth == _DEEPEST or part not in {**assigned, **combined}:
                what = f"combination {name[:40]} is no sum of static cases: {part[:40]}"
                raise mistake("L651", what, row.span, "--load with a static case or load patterns")
            inner = _sum(part, assigned, combined, known, depth + 1)
        for pattern, value in inner.items():
            total[pattern] = total.get(pattern, 0.0) + factor * value
            if abs(total[pattern]) > MOST:
                raise mistake(
                    "L643", f"{name[:40]}: a factor above {MOST:g}", row.span, "check the factors"
                )
    return total
