"""``pound-solve study``: compare the methods on one deck, or run the stability matrix."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pound_solve.cli import common, terminal
from pound_solve.cli.progress import AnalysisProgress, StatusLine
from pound_solve.report.formats import IMAGE_FORMATS

if TYPE_CHECKING:
    from pound_solve.assess.stability.scenes.case import StabilityCase
    from pound_solve.assess.study import Plan

SUMMARY = "error against time of every method on this deck, and advice"
EXAMPLES = (
    ("model.inp", "error and time of every method"),
    ("model.inp --methods EXACT,NEWMARK", "of some"),
    ("--stability --quick", "stiff and extreme scenes"),
)
#: options of only one of the two forms
OF_A_DECK = ("set", "records", "methods", "steps", "tols", "repeat", "longest", "picture", "out")
OF_THE_MATRIX = ("family", "law", "quick")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    common.add_deck(parser, nargs="?")
    parser.add_argument("--methods", metavar="M,M,...", help="methods (default: all but LAPLACE)")
    parser.add_argument(
        "--steps",
        metavar="DT,DT,...",
        help="time steps (default: halves of the record's until it suffices)",
    )
    parser.add_argument("--tols", metavar="TOL,TOL,...", help="tolerances of AUTO and LAGUERRE")
    parser.add_argument("--repeat", type=int, metavar="N", help="timed runs of each (default 3)")
    parser.add_argument(
        "--longest", type=common.finite, metavar="S", help="CPU seconds a run may take (default 5)"
    )
    text = f"draw error against time into a file, ending in {', '.join(IMAGE_FORMATS)}"
    parser.add_argument("--picture", type=common.picture, metavar="FILE", help=text)
    parser.add_argument(
        "-o", "--out", type=Path, metavar="DIR", help="folder of the study (default: the deck's)"
    )
    matrix = parser.add_argument_group("the stability matrix")
    text = "instead of a deck: stiff and extreme scenes with every law by every method, and how they end"
    matrix.add_argument("--stability", action="store_true", help=text)
    matrix.add_argument("--family", choices=("linear", "contact", "hysteresis"), help="these scenes only")
    matrix.add_argument("--law", help="scenes with this law only")
    matrix.add_argument("--quick", action="store_true", help="leave out the heavy scenes")


def execute(args: argparse.Namespace) -> int:
    """Run the study of a deck or the stability matrix."""
    if args.stability and args.deck:
        text = f"--stability has scenes of its own: leave out {args.deck}"
        return common.complain(text, common.MISTAKES)
    for name in OF_A_DECK if args.stability else OF_THE_MATRIX:
        if getattr(args, name):
            owner = "a study of a deck" if args.stability else "--stability"
            return common.complain(f"--{name} belongs to {owner}", common.MISTAKES)
    if args.stability:
        return _stability(args)
    if not args.deck:
        text = "study takes a deck, or --stability for the scenes of the stability matrix"
        return common.complain(text, common.MISTAKES)
    return _study_of_a_deck(args)


def _study_of_a_deck(args: argparse.Namespace) -> int:
    """Run the methods on a deck, write the study's results file and report, and print the report."""
    from pound_deck.diagnostics import render
    from pound_solve.assess import study
    from pound_solve.report.text import render as report

    request, line = common.request(args), StatusLine()
    if not common.drawable(args.picture):
        return common.MISTAKES
    try:
        result, ready = study.run(request, _plan(args), line.show)
    finally:
        line.clear()
    results = study.write(result, ready, request.path(".study.h5"))
    if ready.warnings:
        terminal.tell(render(ready.warnings, ready.files))
    if result.warning:
        common.complain(f"warning: {result.warning}")
    with results:
        print(report(results))
        print(f"{result.sentence}\n{request.path('.study.rpt')}\n{request.path('.study.h5')}")
        if args.picture:
            from pound_solve.report import plot

            plot.draw_into(results, "study", args.picture)
    return common.DONE


def _plan(args: argparse.Namespace) -> Plan:
    """Plan of the study; items without an option keep their defaults."""
    from pound_solve.assess.advice import MethodStudyError
    from pound_solve.assess.study import Plan

    items: dict[str, Any] = {
        name: getattr(args, name) for name in ("repeat", "longest") if getattr(args, name) is not None
    }
    if args.methods:
        items["methods"] = tuple(word.strip().upper() for word in args.methods.split(","))
    for name in ("steps", "tols"):
        words = getattr(args, name)
        if words:
            values = common.numbers(
                words.replace(",", " ").split(), f"--{name} takes numbers", MethodStudyError
            )
            items[name] = tuple(sorted(values, reverse=True))
    plan = Plan(**items)
    if plan.repeat < 1 or not plan.longest > 0 or any(x <= 0 for x in (*plan.steps, *plan.tols)):
        raise MethodStudyError("--repeat, --longest, --steps and --tols must be above zero")
    return plan


def _stability(args: argparse.Namespace) -> int:
    """Run the stability matrix and print its page; the status is 1 where a run failed by a fault."""
    from pound_solve.assess.stability import judge, page, scenes

    families = (args.family,) if args.family else judge.FAMILIES
    law = (args.law or "").upper()

    def chosen(case: StabilityCase) -> bool:
        return law in ("", case.law) and not (args.quick and case.heavy)

    runs = sum(map(chosen, scenes.cases(families))) * len(judge.methods())
    if not runs:
        near = f"--family {args.family} has" if args.family else "there are"
        text = f"{near} no scenes with the law {args.law}: see pound-solve list"
        return common.complain(text, common.MISTAKES)
    progress, rows = AnalysisProgress(False, args.interruption.check), []
    for row in judge.matrix(families, chosen):
        rows.append(row)
        doing = f"{len(rows)} of {runs}: {row.case.scene} {row.case.law}"
        progress(len(rows), runs, terminal.fitted(doing, progress.line.width))
    progress.end()
    print(page.page(rows))
    return int(any(row.end == judge.FAULT for row in rows))
