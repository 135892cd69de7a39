"""The command line: ``pound-solve model.inp`` and its verbs."""

from __future__ import annotations

import argparse
import math
import os
import signal
import sys
import threading
import time
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pound_solve import __version__

PICTURES = (
    "frame", "modes", "deformed", "envelopes", "histories", "energy", "loops", "contacts", "collisions",
    "study",
)  # fmt: skip
FORMATS = ("svg", "png", "pdf")  #: of pictures by matplotlib
WIDTH = 69  #: of the line that tells the progress
VERBS = ("run", "check", "study", "report", "export", "plot", "separation", "list", "loop")
#: threads of numpy's linear algebra, as its builds know them
THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


def parser() -> argparse.ArgumentParser:
    """Return the argument parser; ``run`` is the verb where none is given."""
    out = argparse.ArgumentParser(
        prog="pound-solve",
        description="Earthquake pounding of 2-D frames: a text deck in, a report and an HDF5 file out.",
    )
    out.add_argument("--version", action="version", version=f"pound-solve {__version__}")
    verbs = out.add_subparsers(dest="verb", required=True, metavar="VERB")

    def deck(
        name: str, text: str, methods: bool = True, nargs: str | None = None
    ) -> argparse.ArgumentParser:
        p = verbs.add_parser(name, help=text, description=text)
        p.add_argument("deck", nargs=nargs, help="input deck")
        p.add_argument(
            "--set", action="append", default=[], metavar="NAME=VALUE", help="replace a PARAM of the deck"
        )
        p.add_argument(
            "--records", action="append", default=[], type=Path, metavar="DIR", help="folder with records"
        )
        if methods:
            p.add_argument("--method", help="replace METHOD of HISTORY")
            p.add_argument("--dt", type=float, help="replace DT of HISTORY")
            p.add_argument("--tol", type=float, help="replace TOL of HISTORY")
        return p

    run = deck("run", "run a deck (the verb may be left out)")
    run.add_argument(
        "-o", "--out", type=Path, metavar="DIR", help="folder of report and results (default: the deck's)"
    )
    run.add_argument("--quiet", action="store_true", help="print nothing but errors")
    run.add_argument(
        "--explain", action="store_true", help="tell what the run imported, compiled, kept and left out"
    )
    deck("check", "report all mistakes of a deck without running it")
    study = deck(
        "study", "error against time of every method on this deck, and advice", methods=False, nargs="?"
    )
    study.add_argument("--methods", metavar="M,M,...", help="methods (default: all)")
    study.add_argument(
        "--steps",
        metavar="DT,DT,...",
        help="time steps (default: halves of the record's until it suffices)",
    )
    study.add_argument("--tols", metavar="TOL,TOL,...", help="tolerances of AUTO")
    study.add_argument("--repeat", type=int, metavar="N", help="timed runs of each (default 3)")
    study.add_argument("--longest", type=float, metavar="S", help="seconds a run may take (default 5)")
    text = f"draw error against time into a file, ending in {', '.join(FORMATS)}"
    study.add_argument("--picture", type=_picture, metavar="FILE", help=text)
    study.add_argument(
        "-o", "--out", type=Path, metavar="DIR", help="folder of the study (default: the deck's)"
    )
    text = "instead of a deck: stiff and extreme scenes with every law by every method, and how they end"
    matrix = study.add_argument_group("the stability matrix")
    matrix.add_argument("--stability", action="store_true", help=text)
    matrix.add_argument("--family", choices=("linear", "contact", "hysteresis"), help="these scenes only")
    matrix.add_argument("--law", help="scenes with this law only")
    matrix.add_argument("--quick", action="store_true", help="leave out the heavy scenes")
    report = verbs.add_parser("report", help="print the report of a results file")
    report.add_argument("results", help="results file (.h5)")
    report.add_argument("--all", action="store_true", help="cut no long table short")
    export = verbs.add_parser("export", help="write the tables and histories of a results file as CSV")
    export.add_argument("results", help="results file (.h5)")
    export.add_argument("-o", "--out", type=Path, metavar="DIR", help="folder (default: beside the file)")
    text = "draw pictures of a results file (needs matplotlib: the extra plot)"
    plot = verbs.add_parser("plot", help=text, description=text)
    plot.add_argument("results", help="results file (.h5)")
    plot.add_argument(
        "pictures", nargs="*", metavar="PICTURE", help=f"{', '.join(PICTURES)} (default: all)"
    )
    plot.add_argument("-o", "--out", type=Path, metavar="DIR", help="folder (default: the file's)")
    plot.add_argument("--as", dest="ending", default="svg", choices=FORMATS, help="format")
    text = "separation of the buildings by ABS, SRSS and DDC from the peaks of a results file"
    separation = verbs.add_parser("separation", help=text, description=text)
    separation.add_argument("results", help="results file (.h5)")
    separation.add_argument(
        "--periods", type=_two, default=(), metavar="T1,T2", help="of the buildings, in place of the modes'"
    )
    separation.add_argument(
        "--damping", type=_two, default=(), metavar="X1,X2", help="in percent, in place of the modes'"
    )
    listing = verbs.add_parser("list", help="list what a deck may use")
    listing.add_argument(
        "family",
        nargs="?",
        help="section, element, hysteresis, contact, damping, motion, force, record, analysis or method",
    )
    listing.add_argument("name", nargs="?", help="one member: its items")
    text = "drive a hysteresis rule or contact law along a path; print and draw its loop"
    loop = verbs.add_parser("loop", help=text, description=text)
    loop.add_argument("law", help="name of the rule or law")
    loop.add_argument("items", nargs="*", metavar="NAME=VALUE", help="items of its card, as in a deck")
    loop.add_argument("--path", metavar="D,D,...", help="turning points of the deformation")
    loop.add_argument("--file", type=Path, help="file of turning points, any number a line")
    loop.add_argument(
        "--rate",
        type=float,
        metavar="V",
        help="speed of the deformation (default: infinitely slow; of a contact 1)",
    )
    loop.add_argument("--png", type=_picture, metavar="FILE", help="draw with matplotlib into a file")
    loop.add_argument("--svg", type=Path, metavar="FILE", help="draw into an SVG file")
    return out


def _picture(word: str) -> Path:
    """File of a picture by matplotlib, whose ending names the format."""
    path = Path(word)
    if path.suffix.removeprefix(".") not in FORMATS:
        raise argparse.ArgumentTypeError(f"{word}: a picture ends in .{', .'.join(FORMATS)}")
    return path


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit status (0 done, 1 stopped, 2 mistakes, 3 files)."""
    words = list(sys.argv[1:] if argv is None else argv)
    if words and words[0] not in VERBS and not words[0].startswith("-"):
        if len(words) > 1 and not words[1].startswith("-") and not Path(words[0]).exists():
            near = get_close_matches(words[0], VERBS, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            return _complain(f"{words[0]} is neither a verb nor a deck{hint}", 2)
        words.insert(0, "run")
    elif words and words[0].startswith("-") and words[0] not in ("-h", "--help", "--version"):
        words.insert(0, "run")
    args = parser().parse_args(words)
    # before numpy is there: with more threads the digits depend on their number, and small matrices wait
    for name in THREADS:
        os.environ.setdefault(name, "1")
    try:
        return {
            "run": _run,
            "check": _check,
            "study": _study,
            "report": _report,
            "export": _export,
            "plot": _plot,
            "separation": _separation,
            "list": _list,
            "loop": _loop,
        }[args.verb](args)
    except BrokenPipeError:  # the reader of our output has gone: not our mistake
        sys.stderr.close()
        return 0
    except OSError as err:
        return _complain(f"{err.filename or ''}: {err.strerror or err}".lstrip(": "))
    except KeyboardInterrupt:
        return _complain("interrupted", 1)
    except MemoryError:
        cure = "store less (OUTPUT EVERY, NODES, MEMBERS) or use a smaller model"
        return _complain(f"not enough memory: {cure}", 1)
    except Exception as err:
        if os.environ.get("POUND_DEBUG"):
            raise
        kind = type(err).__name__
        text = f"a fault of the program, not of the deck: {kind}: {err}; POUND_DEBUG=1 shows where"
        return _complain(text, 1)


def _complain(text: str, status: int = 3) -> int:
    """Print a line on the error stream and return the exit status; 3 is for files."""
    print(f"pound-solve: {text}", file=sys.stderr)
    return status


def _request(args: argparse.Namespace) -> object:
    from pound_solve.driver.run import Request
    from pound_solve.results import is_hdf5

    if is_hdf5(args.deck):
        text = f"{args.deck} is a results file, not a deck: report, export, plot and separation read it"
        raise SystemExit(_complain(text, 2))
    params = {}
    for item in args.set:
        name, equals, value = item.partition("=")
        if not equals or not name.strip():
            raise SystemExit(_complain(f"--set {item}: write NAME=VALUE", 2))
        params[name.strip()] = value.strip()
    out, records = getattr(args, "out", None), tuple(args.records)
    given = vars(args)
    own = {name: given[name] for name in ("method", "dt", "tol", "explain") if name in given}
    return Request(args.deck, params, out, records, **own)


def _run(args: argparse.Namespace) -> int:
    from pound_deck.diagnostics import render
    from pound_solve.driver import run
    from pound_solve.results import ResultsError

    request = _request(args)
    assert isinstance(request, run.Request)
    progress = _Progress(args.quiet)
    try:
        status, results, ready = run.execute(request, progress)
    except run.DeckError as err:
        print(err, file=sys.stderr)
        return run.MISTAKES
    except ResultsError as err:
        return _complain(str(err))
    except Exception:
        if progress.interrupted:  # a library swallowed it, and could not go on
            raise KeyboardInterrupt from None
        raise
    progress.end()
    if ready.warnings and not args.quiet:
        print(render(ready.warnings, ready.files), file=sys.stderr)
    with results:
        if "checks" in results.tables and not args.quiet:
            for check, value, verdict in results.table("checks"):
                if verdict.startswith("look"):
                    print(f"pound-solve: warning: {check}: {value}; {verdict}", file=sys.stderr)
        if status == run.STOPPED:
            print(f"pound-solve: stopped: {results.message}", file=sys.stderr)
        if args.explain:
            from pound_solve.report.text import render as printed

            print(printed(results, only=("scene", "size", "arrays", "imports")))
        if not args.quiet:
            print(f"{request.path('.rpt')}\n{request.path('.h5')}")
    return status


class _Progress:
    """One line on a terminal, rewritten at most ten times a second; silent in a pipe.

    Remembers an interrupt too: one that falls into a library's clean-up is swallowed there.
    """

    def __init__(self, quiet: bool) -> None:
        self.live = sys.stderr.isatty() and not quiet
        self.began = self.told = time.monotonic()
        self.interrupted = False
        self.main = threading.current_thread() is threading.main_thread()  # only there are handlers set
        if self.main:
            self.before = signal.signal(signal.SIGINT, self._interrupt)

    def _interrupt(self, *_: object) -> None:
        self.interrupted = True
        raise KeyboardInterrupt

    def __call__(self, t: float, end: float, doing: str) -> None:
        if self.interrupted:
            self.interrupted = False
            raise KeyboardInterrupt
        now = time.monotonic()
        if not self.live or (now - self.told < 0.1 and not doing):
            return
        self.told = now
        left = (now - self.began) * (end / t - 1.0) if t > 0 else 0.0
        line = doing or f"t = {t:10.4f} of {end:g}   {100 * t / end:5.1f} %   {left:6.0f} s to go"
        print(f"\r {line:{WIDTH}}", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Clear the line, and let interrupts be as they were."""
        if self.main:
            signal.signal(signal.SIGINT, self.before)
        if self.live:
            print("\r" + " " * (WIDTH + 1) + "\r", end="", file=sys.stderr, flush=True)


def _check(args: argparse.Namespace) -> int:
    from pound_deck.diagnostics import render
    from pound_solve.driver import run

    request = _request(args)
    assert isinstance(request, run.Request)
    try:
        ready = run.prepare(request)
    except run.DeckError as err:
        print(err, file=sys.stderr)
        return run.MISTAKES
    if ready.warnings:
        print(render(ready.warnings, ready.files), file=sys.stderr)
    m = ready.model
    print(
        f"{args.deck}: no mistakes; {len(m.nodes)} nodes, {len(m.elements)} elements, "
        f"{(n := ready.structure.n_free)} unknown{'s' * (n != 1)}"
    )
    return run.DONE


#: options of `study` that only one of its two forms has
OF_A_DECK = ("set", "records", "methods", "steps", "tols", "repeat", "longest", "picture", "out")
OF_THE_MATRIX = ("family", "law", "quick")


def _study(args: argparse.Namespace) -> int:
    if args.stability and args.deck:
        return _complain(f"--stability has scenes of its own: leave out {args.deck}", 2)
    for name in OF_A_DECK if args.stability else OF_THE_MATRIX:
        if getattr(args, name):
            own = "a study of a deck" if args.stability else "--stability"
            return _complain(f"--{name} belongs to {own}", 2)
    if args.stability:
        return _stability(args)
    if not args.deck:
        return _complain("study takes a deck, or --stability for the scenes of the stability matrix", 2)
    return _study_of_a_deck(args)


def _study_of_a_deck(args: argparse.Namespace) -> int:
    from pound_deck.diagnostics import render as told
    from pound_solve.assess import study
    from pound_solve.driver import run
    from pound_solve.report.text import render
    from pound_solve.results import ResultsError

    request = _request(args)
    assert isinstance(request, run.Request)
    live = sys.stderr.isatty()

    if args.picture:
        from pound_solve.report import plot

        try:
            plot.ready(args.picture.parent)
        except ImportError:
            return _complain('--picture needs matplotlib: pip install "pound-solve[plot]"', 2)

    def tell(text: str) -> None:
        if live:
            print(f"\r {text:<70}", end="", file=sys.stderr, flush=True)

    try:
        found, ready = study.run(request, _plan(args), tell)
        tell("")
        results = study.write(found, ready, request.path(".study.h5"))
    except run.DeckError as err:
        print(err, file=sys.stderr)
        return run.MISTAKES
    except study.StudyError as err:
        tell("")
        return _complain(str(err), 2)
    except ResultsError as err:
        return _complain(str(err))
    if ready.warnings:
        print(told(ready.warnings, ready.files), file=sys.stderr)
    if found.warning:
        print(f"pound-solve: warning: {found.warning}", file=sys.stderr)
    with results:
        text = render(results)
        request.path(".study.rpt").write_text(text, encoding="ascii", newline="\n")
        print(text)
        print(f"{found.sentence}\n{request.path('.study.rpt')}\n{request.path('.study.h5')}")
        if args.picture:
            plot.draw_into(results, "study", args.picture)
    return 0


def _plan(args: argparse.Namespace) -> Any:
    """What a study is to run, by the options; what is left out stays as `Plan` has it."""
    from pound_solve.assess.study import Plan, StudyError

    given = {name: getattr(args, name) for name in ("repeat", "longest") if getattr(args, name) is not None}
    if args.methods:
        given["methods"] = tuple(word.strip().upper() for word in args.methods.split(","))
    for name in ("steps", "tols"):
        words = getattr(args, name)
        if words:
            numbers = _numbers(words.replace(",", " ").split(), f"--{name} takes numbers", StudyError)
            given[name] = tuple(sorted(numbers, reverse=True))
    plan = Plan(**given)
    if plan.repeat < 1 or not plan.longest > 0 or any(x <= 0 for x in (*plan.steps, *plan.tols)):
        raise StudyError("--repeat, --longest, --steps and --tols are above zero")
    return plan


def _report(args: argparse.Namespace) -> int:
    from pound_solve.report.text import render
    from pound_solve.results import Results, ResultsError

    try:
        with Results.open(args.results) as results:
            sys.stdout.write(render(results, limit=0 if args.all else None))
    except ResultsError as err:
        return _complain(str(err))
    return 0


def _export(args: argparse.Namespace) -> int:
    from pound_solve.report.export import export_csv
    from pound_solve.results import Results, ResultsError

    folder = args.out or Path(args.results).with_suffix("")
    try:
        with Results.open(args.results) as results:
            for path in export_csv(results, folder):
                print(path)
    except ResultsError as err:
        return _complain(str(err))
    return 0


def _plot(args: argparse.Namespace) -> int:
    from pound_solve.report import plot
    from pound_solve.results import Results, ResultsError

    unknown = [name for name in args.pictures if name not in PICTURES]
    if unknown:
        return _complain(f"there is no picture {unknown[0]}: choose from {', '.join(PICTURES)}", 2)
    try:
        with Results.open(args.results) as results:
            can = plot.possible(results)
            if lacking := [name for name in args.pictures if name not in can]:
                needs = ", ".join(plot.PICTURES[lacking[0]][1])
                return _complain(f"{args.results} lacks what the picture {lacking[0]} needs: {needs}", 2)
            folder = args.out or results.path.parent
            drawn, left_out = plot.draw(results, args.pictures or can, folder, args.ending)
    except ResultsError as err:
        return _complain(str(err))
    except ImportError:
        return _complain('pictures need matplotlib: pip install "pound-solve[plot]"', 2)
    for path in drawn:
        print(path)
    if left_out:
        told = "; ".join(f"{', '.join(names)} (no {what})" for what, names in left_out.items())
        print(f"pound-solve: left out, nothing to draw: {told}", file=sys.stderr)
    return 0 if drawn else 2


def _two(word: str) -> tuple[float, float]:
    """Two positive numbers of an option."""
    try:
        first, second = (float(x) for x in word.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{word[:60]}: write two numbers, as 0.2,0.3") from None
    if not (0.0 < first < math.inf and 0.0 < second < math.inf):
        raise argparse.ArgumentTypeError(f"{word[:60]}: both must be above 0")
    return first, second


def _separation(args: argparse.Namespace) -> int:
    from pound_solve.report import separation
    from pound_solve.results import Results, ResultsError

    try:
        with Results.open(args.results) as results:
            print(separation.text(results, args.periods, args.damping))
    except (ResultsError, separation.SeparationError) as err:
        return _complain(str(err))
    return 0


def _list(args: argparse.Namespace) -> int:
    from pound_solve.report.deck_reference import listing

    try:
        print(listing(args.family, args.name))
    except KeyError as err:
        return _complain(str(err.args[0]), 2)
    return 0


def _loop(args: argparse.Namespace) -> int:
    from pound_solve.assess import law_test
    from pound_solve.report import text_plot

    try:
        family = args.law.lower() in law_test.AXES and bool(args.items)
        spec = law_test.law_of(f"{args.law} {args.items.pop(0)}" if family else args.law)
        spring, items = law_test.specimen(spec, args.items)
        path = _turning_points(args) or law_test.protocol(spring)
        rate = float(spring.is_contact) if args.rate is None else args.rate
        found = law_test.trace(spring.law, path, rate)
    except law_test.LawTestError as err:
        return _complain(str(err), 2)
    texts = (f"{spec.name} {items}", *law_test.AXES[spec.family])
    print(f"{texts[0]}\n\n{law_test.table(found.corners)}\n\n{text_plot.letters(found.curve)}")
    if args.svg:
        args.svg.write_text(text_plot.svg(found.curve, *texts), encoding="utf-8", newline="\n")
    if args.png:
        from pound_solve.report import plot

        try:
            plot.loop(found.curve, *texts, args.png)
        except ImportError:
            return _complain(
                '--png needs matplotlib: pip install "pound-solve[plot]"; --svg needs nothing', 2
            )
    return 0


def _turning_points(args: argparse.Namespace) -> list[float]:
    """Numbers of --path or --file; empty where neither is given."""
    from pound_solve.assess.law_test import LawTestError

    if args.path and args.file:
        raise LawTestError("give --path or --file, not both")
    text = args.file.read_text(encoding="utf-8") if args.file else args.path or ""
    words = [w for line in text.splitlines() for w in line.split("#")[0].replace(",", " ").split()]
    out = _numbers(words, "--path and --file take deformations", LawTestError)
    if (args.path is not None or args.file) and not out:
        raise LawTestError("--path and --file take one deformation at least")
    return out


def _numbers(words: Sequence[str], takes: str, error: type[Exception]) -> list[float]:
    """Finite numbers; raise `error`, which says what the option `takes`, at the first word that is none."""
    out = []
    for word in words:
        try:
            out.append(float(word))
        except ValueError:
            raise error(f"{word[:60]} is no number: {takes}") from None
        if not math.isfinite(out[-1]):
            raise error(f"{word[:60]} is no finite number")
    return out


def _stability(args: argparse.Namespace) -> int:
    from pound_solve.assess import stability, stress_scenes

    families = (args.family,) if args.family else stability.FAMILIES
    law = (args.law or "").upper()

    def chosen(case: stress_scenes.Case) -> bool:
        return law in ("", case.law) and not (args.quick and case.heavy)

    runs = sum(map(chosen, stress_scenes.cases(families))) * len(stability.methods())
    if not runs:
        near = f"--family {args.family} has" if args.family else "there are"
        return _complain(f"{near} no scenes with the law {args.law}: see pound-solve list", 2)
    progress, rows = _Progress(quiet=False), []
    for row in stability.matrix(families, chosen):
        rows.append(row)
        doing = f"{len(rows)} of {runs}: {row.case.scene} {row.case.law}"
        progress(len(rows), runs, doing[:WIDTH])
    progress.end()
    print(stability.page(rows))
    return int(any(row.end == stability.FAULT for row in rows))
