"""``pound-solve spectrum``: response spectra of records, of a deck's motions, and of floors."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from pound_solve.cli import common, terminal
from pound_solve.report.formats import IMAGE_FORMATS

if TYPE_CHECKING:
    from pound_deck.model import Units
    from pound_solve.assess.spectra import AccelerationSource
    from pound_solve.report.spectrum import SpectrumCurve

SUMMARY = "response spectra of records, of the motions of a deck, or of the floors of a run"
EXAMPLES = (
    ("quake.at2 --picture spectrum.svg", "of a record"),
    ("model.inp", "of the motions of a deck"),
    ("model.h5 --node 12", "of a floor"),
)
DEFAULT = "0.01:10:91"  #: thirty periods per decade
MAX_PERIODS = 10_000  #: most periods


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    text = "record, known record, deck (.inp) or results file (.h5); several are shown together"
    parser.add_argument("sources", nargs="+", metavar="FILE", help=text)
    parser.add_argument(
        "--item",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="item of the RECORD card (records)",
    )
    parser.add_argument(
        "--node",
        action="append",
        default=[],
        type=int,
        metavar="N",
        help="node of the floor (results files)",
    )
    parser.add_argument(
        "--direction", choices=("X", "Y", "R"), default="X", help="of the nodes (default X)"
    )
    text = f"FIRST:LAST:COUNT or a list (default {DEFAULT})"
    parser.add_argument("--periods", type=_periods, default=DEFAULT, metavar="T,T,...", help=text)
    parser.add_argument(
        "--damping", type=_damping, default="5", metavar="X,X,...", help="in percent (default 5)"
    )
    parser.add_argument("-o", "--out", type=Path, metavar="FILE", help="write the spectra as CSV")
    text = f"draw the spectra into a file, ending in {', '.join(IMAGE_FORMATS)}"
    parser.add_argument("--picture", type=common.picture, metavar="FILE", help=text)
    common.add_deck_options(parser)


def _periods(word: str) -> list[float]:
    """Periods of an option: a list, or the first, the last and the number of equal ratios."""
    values = common.numbers(
        word.replace(":", ",").split(","), "--periods takes numbers", argparse.ArgumentTypeError
    )
    if min(values) <= 0.0:
        raise argparse.ArgumentTypeError(f"{word[:60]}: periods must be above 0")
    if ":" not in word:
        return values
    if word.count(":") != 2 or "," in word or not values[0] < values[1]:
        raise argparse.ArgumentTypeError(f"{word[:60]}: write FIRST:LAST:COUNT, as {DEFAULT}")
    first, last, count = values
    if count != int(count) or not 2 <= count <= MAX_PERIODS:
        raise argparse.ArgumentTypeError(f"{word[:60]}: COUNT is a whole number from 2 to {MAX_PERIODS}")
    steps = int(count) - 1
    return [first * (last / first) ** (k / steps) for k in range(steps)] + [last]


def _damping(word: str) -> list[float]:
    """Damping ratios from percentages of an option."""
    values = common.numbers(word.split(","), "--damping takes percentages", argparse.ArgumentTypeError)
    if not all(0.0 <= x < 100.0 for x in values):
        raise argparse.ArgumentTypeError(f"{word[:60]}: damping is from 0 to below 100 percent")
    return [x / 100.0 for x in values]


def execute(args: argparse.Namespace) -> int:
    """Print the spectra; write and draw them into the files given."""
    from pound_solve.report import spectrum as report

    if not common.drawable(args.picture):
        return common.MISTAKES
    units, curves = _curves(args)
    print(report.text(units, curves))
    if args.out:
        report.write_csv(args.out, units, curves)
    if args.picture:
        from pound_solve.report import plot

        plot.spectra(curves, units, args.picture)
    return common.DONE


def _curves(args: argparse.Namespace) -> tuple[Units, list[SpectrumCurve]]:
    """Spectra of all motions of all files, and their units."""
    from pound_deck.diagnostics import render
    from pound_solve.assess.spectra import SpectrumError
    from pound_solve.loading.spectrum import response_spectrum
    from pound_solve.report.spectrum import SpectrumCurve

    sources = [_source(name, args) for name in args.sources]
    units = sources[0].units
    for name, source in zip(args.sources, sources):
        if source.warnings:
            terminal.tell(render(source.warnings, source.files))
        other = source.units
        if (other.length, other.time) != (units.length, units.time):
            raise SpectrumError(
                f"{name} is in {other.length} and {other.time}, {args.sources[0]} in {units.length} and "
                f"{units.time}: show them apart"
            )
    curves = []
    for title, a in (item for source in sources for item in source.accelerations.items()):
        try:
            curves.append(SpectrumCurve(title, a, response_spectrum(a, args.periods, args.damping)))
        except ValueError as err:  # a period too short
            raise SpectrumError(f"{title}: {err}") from None
    return units, curves


def _source(name: str, args: argparse.Namespace) -> AccelerationSource:
    """Motions of one file."""
    from pound_solve.assess import spectra
    from pound_solve.driver.reading import is_deck
    from pound_solve.driver.request import Request
    from pound_solve.results import Results, is_hdf5

    kind = "deck" if is_deck(name) else "record"
    if name.endswith(".h5") or is_hdf5(name):
        kind = "results file"
    for option, to in (("node", "results file"), ("set", "deck"), ("item", "record")):
        if getattr(args, option) and to != kind:
            raise spectra.SpectrumError(f"--{option} belongs to a {to}, and {name} is a {kind}")
    if kind == "record":
        return spectra.of_record(name, args.item, args.records)
    if kind == "deck":
        request = Request(name, common.parameters(args.set), records=tuple(args.records))
        return spectra.of_deck(request)
    if not args.node:
        raise spectra.SpectrumError(f"{name} is a results file: choose the floor with --node")
    with Results.open(name) as results:
        source = spectra.of_nodes(results, args.node, args.direction)
        if results.status != "done":
            common.complain(f"warning: {name} ended early, at {results.last_time:g} {results.units.time}")
    if remark := spectra.coarse(source, min(args.periods)):
        common.complain(f"warning: {name}: {remark}")
    return source
