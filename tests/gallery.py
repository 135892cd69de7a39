"""The pictures of runs in README and manual, drawn by the commands of a user from examples without records.

Other versions of matplotlib draw other bytes, so no test compares the files: ``python
tests/refresh_manual.py gallery`` draws them anew.
"""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from pound_solve.cli.main import main
from pound_solve.report.plot import PICTURES, style

ROOT: Final = Path(__file__).parents[1]
FOLDER: Final = ROOT / "manual" / "pictures"
EXAMPLES: Final = ROOT / "examples"
FRAMES: Final = EXAMPLES / "06_unequal_frames" / "unequal_frames.inp"
PUSHED: Final = EXAMPLES / "03_concrete_frame" / "concrete_frame.inp"
SUITE: Final = EXAMPLES / "08_gap_suite"
STUDIED: Final = EXAMPLES / "01_two_oscillators" / "two_oscillators.inp"
FILM: Final = "run_animation.gif"
#: file of every picture of one run, and that of two runs over each other
FILES: Final = {name: FILM if name == "animation" else f"run_{name}.png" for name in PICTURES}
TWO_RUNS: Final = "runs_storeys.png"
TUTORIAL: Final = "tutorial_contact_force.png"
TRENDS: Final = "sweep_trends.png"
TORNADO: Final = "uncertainty.png"
SEARCH: Final = "optimize.png"
BARS: Final = "sensitivity.png"
FIT: Final = "calibrate.png"
MEASURED: Final = EXAMPLES / "validation" / "cantilevers" / "calibrate.toml"
BEST: Final = EXAMPLES / "optimize"
#: decks on the page of the gallery, each with the picture of its one page
EXHIBITS: Final = {
    "01_two_oscillators/two_oscillators.inp": "page_two_oscillators.png",
    "03_concrete_frame/concrete_frame.inp": "page_concrete_frame.png",
    "05_rocking_wall/section.inp": "page_rocking_wall.png",
    "06_unequal_frames/unequal_frames.inp": "page_unequal_frames.png",
    "07_row_of_three/row_of_three.inp": "page_row_of_three.png",
}
PAGE: Final = ROOT / "manual" / "gallery.md"
AT_PEAK: Final = ("deformed", "diagrams")
ALL_FILES: Final = {
    *FILES.values(),
    *EXHIBITS.values(),
    TWO_RUNS,
    TUTORIAL,
    TRENDS,
    TORNADO,
    SEARCH,
    BARS,
    FIT,
}
RESOLUTION: Final = 80  #: dots per inch
COLOURS: Final = 48  #: of a file, which keeps it small
FILM_WIDTH: Final = 440  #: dots
FILM_SECONDS: Final = 20
SHADES: Final = 8  #: from white to each colour of a film


def draw() -> None:
    """Draw all of them into the folder of the manual's pictures."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        small = folder / "small.mplstyle"
        small.write_text(f"savefig.dpi: {RESOLUTION}\n", "utf-8")
        call(FRAMES, "-o", folder / "pounding")
        call(FRAMES, "-o", folder / "apart", "--set", "pounding=0")
        call(PUSHED, "-o", folder)
        call(STUDIED, "-o", folder)
        call("study", STUDIED, "--methods", "EXACT,NEWMARK,CENTRAL", "-o", folder)
        look = "--as", "png", "--style", small, "-o", folder / "drawn"
        frames, apart = (folder / run / f"{FRAMES.stem}.h5" for run in ("pounding", "apart"))
        call("plot", frames, *look)
        call("plot", frames, *AT_PEAK, "--at-peak", "largest", *look)
        call("plot", frames, "animation", "--as", "gif", "-o", folder / "drawn")
        call("plot", folder / f"{PUSHED.stem}.h5", "capacity", "performance", *look)
        call("plot", next(folder.glob("*study*.h5")), "study", *look)
        call("plot", frames, apart, "storeys", *look)
        call("plot", folder / f"{STUDIED.stem}.h5", "contact_force", *look)
        shutil.copytree(SUITE, folder / "suite")
        call("motions", folder / "suite" / "motions.inp", "-o", folder / "suite" / "suite")
        call("sweep", folder / "suite" / "gaps.toml", "--quiet", "-o", folder / "sweep")
        call("plot", folder / "sweep" / "sweep.h5", *look)
        reduce(folder / "drawn" / TRENDS, FOLDER / TRENDS)
        call("uncertainty", folder / "suite" / "scatter.toml", "--quiet", "--picture", folder / TORNADO)
        shutil.copytree(BEST, folder / "best")
        call("motions", folder / "best" / "four_motions.inp", "-o", folder / "best" / "suite")
        call("optimize", folder / "best" / "bumpers.toml", "--quiet", "--picture", folder / SEARCH)
        bars, fit, out = folder / BARS, folder / FIT, folder / "fit"
        call("sensitivity", folder / "suite" / "sensitivity.toml", "--quiet", "--picture", bars)
        call("calibrate", MEASURED, "-o", out, "--quiet", "--picture", fit)
        for file in (TORNADO, SEARCH, BARS, FIT):
            reduce(folder / file, FOLDER / file)
        stems = {"capacity": PUSHED.stem, "performance": PUSHED.stem, "study": f"{STUDIED.stem}.study"}
        for picture, file in FILES.items():
            drawn = folder / "drawn" / f"{stems.get(picture, FRAMES.stem)}_{picture}{Path(file).suffix}"
            reduce(drawn, FOLDER / file)
        for name, file in ((f"*_vs_*_{FRAMES.stem}_storeys", TWO_RUNS), (f"{STUDIED.stem}_*", TUTORIAL)):
            (drawn,) = (folder / "drawn").glob(f"{name}.png")
            reduce(drawn, FOLDER / file)
        exhibit(folder, look)


def exhibit(folder: Path, look: Sequence[str | Path]) -> None:
    """Draw the one page of every exhibit, and write the first pages of their reports into the gallery."""
    page = PAGE.read_text("utf-8")
    for deck, file in EXHIBITS.items():
        out = folder / Path(deck).stem
        call(EXAMPLES / deck, "-o", out)
        call("plot", out / f"{out.name}.h5", "summary", *look)
        reduce(folder / "drawn" / f"{out.name}_summary.png", FOLDER / file)
        page = with_first_page(page, deck, (out / f"{out.name}.rpt").read_text("utf-8"))
    PAGE.write_text(page, encoding="utf-8", newline="\n")


def first_page(report: str) -> str:
    """Section 1 of a report."""
    found = re.search(r"^1  SUMMARY\n.*?(?=^2  [A-Z])", report, re.DOTALL | re.MULTILINE)
    assert found
    return found[0].strip() + "\n"


def shown_page(page: str, deck: str) -> str:
    """First page of the report of a deck as the gallery shows it."""
    _, _, after = page.partition(f"<!-- page one: {deck} -->\n```\n")
    return after.partition("```\n")[0]


def with_first_page(page: str, deck: str, report: str) -> str:
    """The gallery with the first page of this report."""
    return page.replace(
        f"{deck} -->\n```\n{shown_page(page, deck)}", f"{deck} -->\n```\n{first_page(report)}"
    )


def call(*words: str | Path) -> None:
    """Run a command of the program."""
    assert main([str(word) for word in words]) == 0, words


def reduce(drawn: Path, file: Path) -> None:
    """Write a picture or film with few colours, a film also in few dots."""
    from PIL import Image, ImageSequence  # of matplotlib

    with Image.open(drawn) as image:
        if drawn.suffix != ".gif":
            image.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE).save(file, optimize=True)
            return
        size = FILM_WIDTH, round(image.height * FILM_WIDTH / image.width)
        of_style = palette()
        shots = [
            shot.convert("RGB").resize(size).quantize(palette=of_style, dither=Image.Dither.NONE)
            for shot in ImageSequence.Iterator(image)
        ]
    shots[0].save(
        file, save_all=True, append_images=shots[1:], loop=0, duration=FILM_SECONDS * 1000 // len(shots)
    )


def palette() -> Any:
    """Shades of the program's colours for a film, in which few dots are red or green."""
    from matplotlib.colors import to_rgb
    from PIL import Image

    with style.sheet():
        colours = [np.array(to_rgb(c)) for c in ("black", style.BLUE, style.RED, style.GREEN)]
    shades = [1.0 + x * (colour - 1.0) for colour in colours for x in np.linspace(0.0, 1.0, SHADES)]
    image = Image.new("P", (1, 1))
    image.putpalette([round(255 * float(x)) for shade in shades for x in shade])
    return image
