"""Cases of the fuzzer: what is given to the program, from a kind, a seed and a number.

A case depends on these three and the sources alone, so that a fault is found again by its number.
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from random import Random
from unittest import mock

from agency_files import FILES
from decks import NAMED
from fuzz.attacks import attacked
from fuzz.mutation import damaged, encoded, items, mutated, number, rescaled, revalued, text, words
from imports.ruaumoko_decks import IN_SPACE, OSCILLATOR, PORTAL, STICK
from pound_solve.numerics.providers import provider
from pound_solve.report.plot.catalog import PICTURES
from sweep.small import DECK as WALL
from sweep.small import STUDY, sine
from verification.generated import laws
from verification.generated.decks import deck

ROOT = Path(__file__).parents[2]
#: two masses and a wall, with every section; what a law, a method or a motion needs is put in
SMALL = """TITLE small
UNITS kN m s
PARAM n = 2
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
 4 0 3
 5 3 3 FIX=XYR
ELEMENTS
 1 COL 1 2
 2 COL 1 3
 3 HIT 2 3
 4 WALL 3
 5 BEAM 4 5
 6 DAMP 2 3
 7 FOOT 1 4
PROPS
 COL SPRING KX=4000 {rule}
 HIT CONTACT GAP=0.004 {contact}
 WALL CONTACT GAP=0.01 LAW=KELVIN_VOIGT K=1E5 E=0.6
 BEAM FRAME E=2E7 A=0.04 I=1.3E-4
 DAMP DASHPOT CX=5
 FOOT FRAME E=2E7 A=0.04 I=1.3E-4
WEIGHTS
 2 100*n
 3 150
 4 40
LOADS
 4 FY=-20 FX=3
DAMPING
 {damping}
INITIAL
 2 VX=0.1
DRIFT
 "storey" 1 2 HEIGHT=3
EQUAKE
 {motion}
FORCES
 TABLE 4 FX=10 POINTS=0,0,0.1,1,0.2,0
ANALYSIS
 STATIC
 MODAL 2
 {more}HISTORY 0.3 {method}
OUTPUT
 EVERY=0.01
"""
MOTIONS = (
    "SINE AMPLITUDE=8 PERIOD=0.2 DURATION=0.3",
    "TABLE POINTS=0,0,0.1,5,0.2,-5,0.3,0",
    "RECORD FILE=record.txt FORMAT=COLUMNS DT=0.01 COLUMN=1 UNIT=G",
)
METHODS = (
    *("METHOD=AUTO", "METHOD=AUTO TOL=1E-2", "METHOD=EXACT", "METHOD=TAYLOR", "METHOD=NEWMARK DT=0.005"),
    *("METHOD=LAGUERRE", "METHOD=LAGUERRE TOL=1E-4"),
    *("METHOD=HHT DT=0.005", "METHOD=CENTRAL DT=0.001", "METHOD=LAPLACE DT=0.005", ""),
)
#: items of a study: what is put in front of its tables
ASKED = (
    *('method = "NEWMARK"\ndt = 0.02', 'method = "TAYLOR"', "tol = 1e-2", "seconds = 5", "memory = 500"),
    *('histories = ["node/u"]', 'out = "there"', "workers = 1", 'records = ["."]', 'method = "CENTRAL"'),
)
INCREMENTAL = """deck = "wall.inp"
[[motions]]
files = ["first.txt"]
unit = "M/S2"
sa = 0.05
period = 1.0
[ida]
demand = "peak_drift"
step = 0.1
growth = 0.05
runs = 3
"""
#: verbs on a study, the frequent ones several times
OF_STUDIES = ("sweep", "sweep", "sweep", "plan", "ida", "fragility", "separation")
OPTIONS = ("--dt", "--dt", "--tol", "--tol", "--set", "--set", "--method", "--name")
#: verbs that show the texts of results
SHOWN = ("report", "plot", "export", "plot", "vtk", "plot")
SHAKEN = "\n".join(f"{((7 * k) % 11 - 5) / 10}" for k in range(40))


@dataclass(frozen=True)
class Case:
    """What the program is given.

    Attributes
    ----------
    kind : str
    number : int
    files : mapping of str to bytes
    words : tuple of str
        Format of a record, or words of a command line.
    place : float
        Where in a deck an editor asks, as a share of its length.
    """

    kind: str
    number: int
    files: Mapping[str, bytes]
    words: tuple[str, ...] = ()
    place: float = 0.0

    @property
    def command(self) -> str:
        """A command line that gives the program the same."""
        return {
            "deck": "pound-solve check deck.inp",
            "verbs": "pound-solve check deck.inp; pound-solve format --check deck.inp",
            "editor": "pound-solve lsp  # deck.inp opened, and asked for everything",
            "run": "pound-solve run deck.inp",
            "record": f"pound-solve check deck.inp  # FORMAT={self.words[0] if self.words else ''}",
            "results": "pound-solve report model.h5; pound-solve export model.h5; pound-solve run deck.inp",
            "words": "pound-solve list " + " ".join(map(repr, self.words)),
            "options": "pound-solve run wall.inp " + " ".join(map(repr, self.words)),
            "study": f"pound-solve {self.words[0] if self.words else ''} study.toml  # `cases.OF_STUDIES`",
            "import": "pound-solve import legacy.dat -o model.inp",
            "texts": "pound-solve run deck.inp; pound-solve " + " ".join(map(repr, self.words)),
        }[self.kind]


def case(kind: str, seed: int, number: int, bases: Mapping[str, bytes]) -> Case:
    """The case of a kind, a seed and a number; `bases` are the whole results files that are attacked."""
    rng = Random(f"{seed} {kind} {number}")
    return KINDS[kind](rng, number, bases)


def _deck(rng: Random, number: int, bases: Mapping[str, bytes], kind: str = "deck") -> Case:
    way = rng.random()
    text = rng.choice(decks()) if way < 0.7 else small(rng) if way < 0.99 else generated(number)
    files = {"deck.inp": encoded(mutated(text, rng, decks()), rng)}
    part = rng.choice(decks()).split("\n")
    at = rng.randrange(len(part))
    files["part.inc"] = encoded("\n".join(part[at : at + 10]), rng)
    return Case(kind, number, files, place=rng.random())


def _run(rng: Random, number: int, bases: Mapping[str, bytes]) -> Case:
    text = revalued(small(rng), rng) if rng.random() < 0.9 else mutated(small(rng), rng, ())
    return Case("run", number, {"deck.inp": encoded(text, rng, 0.0), "record.txt": SHAKEN.encode()})


def _record(rng: Random, number: int, bases: Mapping[str, bytes]) -> Case:
    name = rng.choice(sorted(FILES))
    files = {"record.txt": encoded(damaged(FILES[name], rng), rng)}
    name = rng.choice((name, "AUTO"))
    more = rng.choice(
        ("", "", " UNIT=G", " COLUMN=2", " DT=0.01", " COMPONENT=2", " SCALE=1E300", " SKIP=1")
    )
    motion = f"RECORD FILE=record.txt FORMAT={name}{more}"
    text = plain(motion=motion)
    return Case("record", number, files | {"deck.inp": text.encode()}, (name,))


def _results(rng: Random, number: int, bases: Mapping[str, bytes]) -> Case:
    name = rng.choice(sorted(bases))
    again = plain(method="METHOD=EXACT RESTART=model.h5").replace("HISTORY 0.3", "HISTORY 0.4")
    whole = bases[name]
    files = {"model.h5": attacked(whole, rng), "whole.h5": whole, "deck.inp": again.encode()}
    return Case("results", number, files, (name,))


def _words(rng: Random, number: int, bases: Mapping[str, bytes]) -> Case:
    pool = (*words(), *items(), "element", "method", "contact", "", "-", "é", "\x1b", "x" * 3000, "a=b")
    return Case("words", number, {}, tuple(rng.choice(pool) for _ in range(rng.randint(0, 2))))


def _options(rng: Random, number_: int, bases: Mapping[str, bytes]) -> Case:
    given: list[str] = []
    for _ in range(rng.choice((1, 1, 2))):
        option = rng.choice(OPTIONS)
        value = number(rng)
        if option == "--set":
            value = f"{rng.choice(('k', 'gap', 'scale', 'record', 'K', 'q', ''))}={value}"
        elif option == "--name":
            value = rng.choice((value, text(rng)))
        elif option == "--method" and rng.random() < 0.5:
            value = rng.choice(("NEWMARK", "exact", "TAYLOR", "CENTRAL", "AUTO", "LAPLACE", "HHT"))
        if "\0" not in value:  # no command line holds it
            given += (option, value)
    return Case("options", number_, wall(), tuple(given))


def _study(rng: Random, number_: int, bases: Mapping[str, bytes]) -> Case:
    verb = rng.choice(OF_STUDIES)
    whole = INCREMENTAL if verb == "ida" else STUDY
    asked = "\n".join(rng.sample(ASKED, rng.choice((0, 1, 2))))
    changed = rng.choice((rescaled, rescaled, damaged))(f"{asked}\n{whole}", rng)
    return Case("study", number_, wall() | {"study.toml": encoded(changed, rng, 0.03)}, (verb,))


def _import(rng: Random, number_: int, bases: Mapping[str, bytes]) -> Case:
    old = rng.choice((STICK, OSCILLATOR, PORTAL, IN_SPACE))
    return Case("import", number_, {"legacy.dat": encoded(rng.choice((rescaled, damaged))(old, rng), rng)})


def _texts(rng: Random, number_: int, bases: Mapping[str, bytes]) -> Case:
    texts = [text(rng) if rng.random() < 0.6 else f"plain {k}" for k in range(5)]
    texts[1:] = [own.replace('"', "'") for own in texts[1:]]  # what stands in quotes holds none
    verb = rng.choice(SHOWN)
    shown = (verb, rng.choice(sorted(PICTURES))) if verb == "plot" else (verb,)
    return Case("texts", number_, {"deck.inp": encoded(NAMED.format(*texts), rng, 0.0)}, shown)


def wall() -> dict[str, bytes]:
    """The small deck of sweeps and its records, which are shorter."""
    texts = {"wall.inp": WALL, "first.txt": sine(3.0, 0.5, 50), "second.txt": sine(2.0, 0.9, 50)}
    return {name: own.encode() for name, own in texts.items()}


KINDS: dict[str, Callable[[Random, int, Mapping[str, bytes]], Case]] = {
    "deck": _deck,
    "verbs": partial(_deck, kind="verbs"),
    "editor": partial(_deck, kind="editor"),
    "run": _run,
    "record": _record,
    "results": _results,
    "words": _words,
    "options": _options,
    "study": _study,
    "import": _import,
    "texts": _texts,
}


@cache
def generated(number: int) -> str:
    """One of a hundred decks of buildings side by side."""
    return deck(number % 100)


@cache
def decks() -> tuple[str, ...]:
    """Texts of all decks below ``examples`` and ``tests``."""
    paths = [*(ROOT / "examples").rglob("*.in[pc]"), *(ROOT / "tests").rglob("*.inp")]
    return tuple(path.read_text("utf-8") for path in sorted(paths))


def plain(motion: str = MOTIONS[0], method: str = "METHOD=EXACT") -> str:
    """The small deck with a rule and a law that every method takes."""
    rule, contact, damping = "FX=60 RULE=BILINEAR R=0.1", "LAW=LINEAR K=1E5", "MODAL XI=0.05"
    return SMALL.format(rule=rule, contact=contact, damping=damping, motion=motion, more="", method=method)


def small(rng: Random) -> str:
    """A small deck with a rule, a contact law, damping, a motion and a method."""
    straight = rng.random() < 0.5
    return SMALL.format(
        rule="FX=60 " + laws.hysteresis(rng, 60.0, 0.015, straight),
        contact=laws.contact(rng, 100.0, 0.001, 1e6, straight),
        damping=rng.choice(("", "RAYLEIGH XI=0.05 OMEGA=20,80", "MODAL XI=0.05", "RAYLEIGH ALPHA=0.5")),
        motion=rng.choice(MOTIONS),
        more=rng.choice(("", "", "PUSHOVER NODE=4 TARGET=0.02 STEPS=5\n ")),
        method=rng.choice(METHODS),
    )


def bases(folder: Path) -> dict[str, bytes]:
    """Whole results files: of a run, of a study, and one with all tables; the same with any kernels."""
    from contextlib import redirect_stderr, redirect_stdout

    from output import sample
    from pound_solve.cli.main import main

    deck = folder / "base.inp"
    deck.write_text(plain())
    with (
        mock.patch.dict(os.environ, POUND_COMPILE="0"),
        redirect_stdout(io.StringIO()),
        redirect_stderr(io.StringIO()) as told,
    ):
        provider.cache_clear()
        for words in (
            ["run", str(deck), "--quiet"],
            ["study", str(deck), "--methods", "EXACT", "--repeat", "1", "--longest", "600"],
        ):
            assert main(words) == 0, told.getvalue()
    provider.cache_clear()
    sample.write(folder / "sample.h5")
    names = ("base.h5", "base.study.h5", "sample.h5")
    return {name: (folder / name).read_bytes() for name in names}
