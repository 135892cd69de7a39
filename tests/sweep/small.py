"""A small deck, records, a study of them, and an executor that runs in this process."""

import math
from concurrent.futures import Executor, Future

from pound_solve.sweep.execution.executors import Engine
from pound_solve.sweep.session import Session
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.study import read

DECK = """TITLE  A mass between a wall and a spring
UNITS  kN m s
PARAM  k = 4000   gap = 0.01   scale = 1
PARAM  record = "first.txt"
NODES
   1  0 0  FIX=XYR
   2  3 0  FIX=YR
ELEMENTS
   1  COLUMN 1 2
   2  WALL 2
PROPS
   COLUMN SPRING KX=k
   WALL CONTACT GAP=gap LAW=KELVIN_VOIGT K=1E6 E=0.65
WEIGHTS
   2 981
DRIFT
   "storey" 1 2 HEIGHT=3
EQUAKE
   RECORD record SCALE=scale
ANALYSIS
   MODAL 1
   HISTORY 1
"""

STUDY = """deck = "wall.inp"

[grid]
gap = [0.01, 0.02]
k = [4000, 5000.5]

[[motions]]
files = ["first.txt", "se*.txt"]
unit = "M/S2"
scale = [1, 2.5]
"""


def sine(amplitude, period, n=100, dt=0.02):
    """Text of a record."""
    rows = (f"{dt * i:.4f} {amplitude * math.sin(2 * math.pi * dt * i / period):.6f}" for i in range(n))
    return "\n".join(rows) + "\n"


def record(path, amplitude, period, n=100, dt=0.02):
    path.write_text(sine(amplitude, period, n, dt))


def folder(tmp_path, study=STUDY, deck=DECK):
    """The study's file in a folder with all that it names."""
    (tmp_path / "wall.inp").write_text(deck)
    record(tmp_path / "first.txt", 3.0, 0.5)
    record(tmp_path / "second.txt", 2.0, 0.9)
    path = tmp_path / "walls.toml"
    path.write_text(study)
    return path


class Here(Executor):
    """Runs at once, in this process; counts the runs."""

    def __init__(self):
        self.runs = 0

    def submit(self, function, /, *args):
        self.runs += 1
        future = Future()
        try:
            future.set_result(function(*args))
        except BaseException as error:
            future.set_exception(error)
        return future


def session(path, retry=False, piece=(1, 1), executor=None, notes=True):
    own = executor or Here()
    return Session(read(Document.read(str(path))), Engine(lambda: own, 1, 1, 1, notes), piece, retry)


def swept(path, **options):
    """Carry out what is ahead; return the session."""
    out = session(path, **options)
    out.carry_out(out.agenda.ahead, lambda state: None)
    return out
