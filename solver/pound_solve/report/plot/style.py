"""Base of all pictures: matplotlib (extra `plot`), imported here only, and the style of axes in print.

The style is that of a style sheet, `pound.mplstyle`; one of the user may override it.
"""

from __future__ import annotations

import errno
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from io import BytesIO
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any, Final

from pound_deck.files import contents
from pound_solve.report.plot.schema import ChoiceError
from pound_solve.results.whole_file import whole, write

SHEET: Final = Path(__file__).with_name("pound.mplstyle")
BLUE, RED, GREEN = "C0", "C1", "C2"  #: of the style: members; contacts and limits; supports
LINES = 10  #: curves that a style tells apart
EDGE = 0.09  #: free around axes [inches]: letters have other widths in files than in the layout
LONGEST = 26  #: characters of a name in a legend


@contextmanager
def sheet(path: Path | None = None) -> Iterator[None]:
    """Apply the program's style within the block, with the user's style sheet `path` laid over it.

    Raises
    ------
    ImportError
        matplotlib is not installed.
    OSError, ChoiceError
        The file cannot be read, or is no style sheet.
    """
    from matplotlib import rc_context, rc_params_from_file

    with warnings.catch_warnings(), rc_context(rc_params_from_file(SHEET, use_default_template=False)):
        # a character that the font lacks is drawn as a box; SVG files hold the text
        warnings.filterwarnings("ignore", r"Glyph \d+ |Matplotlib currently does not support", UserWarning)
        if path is None:
            yield
            return
        with rc_context(_settings(path)):
            yield


def _settings(path: Path) -> Any:
    """Read the settings of a style sheet: lines ``name: value``, comments after ``#``."""
    from matplotlib import RcParams, rcParams

    settings: Any = RcParams()
    for number, line in enumerate(contents(path).decode("utf-8", "replace").splitlines(), 1):
        name, colon, value = (part.strip() for part in line.partition("#")[0].partition(":"))
        where = f"{path}:{number}"
        if not name and not colon:
            continue
        if not colon:
            raise ChoiceError(f"{where}: a line of a style sheet reads `name: value`, as `font.size: 9`")
        if name not in rcParams:
            near = get_close_matches(name, rcParams, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise ChoiceError(f"{where}: matplotlib has no setting {name}{hint}")
        try:
            settings[name] = value
        except ValueError as err:
            raise ChoiceError(f"{where}: {err}") from None
    return settings


def ready(folder: Path) -> None:
    """Make the folder of pictures where it is missing, and check that pictures can be drawn.

    Raises
    ------
    ImportError
        matplotlib is not installed.
    OSError
        The folder cannot be made.
    """
    figure()
    folder.mkdir(parents=True, exist_ok=True)


def figure(width: float = 7.0, height: float = 4.5, title: str = "") -> Any:
    """Make an empty figure of a size in inches.

    Raises
    ------
    ImportError
        matplotlib is not installed.
    """
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    picture = Figure(figsize=(width, height), layout=ConstrainedLayoutEngine(w_pad=EDGE, h_pad=EDGE))
    if title:
        picture.suptitle(wrapped(title, int(12 * width)))
    return picture


def wrapped(text: str, width: int) -> str:
    """Wrap a text into lines of at most `width` characters."""
    from textwrap import fill

    return fill(text, width)


def short(name: str, most: int = LONGEST) -> str:
    """Shorten a name so that a legend has room for it."""
    return name if len(name) <= most else f"{name[: most - 1]}…"


def grid(axes: Any, x: str = "", y: str = "") -> Any:
    """Draw light grid lines behind the curves, and name the axes."""
    axes.grid(True)
    axes.set_axisbelow(True)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    return axes


def stroke(k: int) -> dict[str, Any]:
    """Colour, line style and marker of curve number `k`, from 0; `LINES` of them differ."""
    from matplotlib import rcParams

    cycle = rcParams["axes.prop_cycle"].by_key()
    return {
        name: values[k % len(values)]
        for name, values in cycle.items()
        if name in ("color", "linestyle", "marker")
    }


def legend(axes: Any, handles: Sequence[Any] | None = None, title: str = "") -> None:
    """Add a legend beside the axes, where nothing is drawn."""
    named: dict[str, Any] = {"handles": handles} if handles is not None else {}
    count = len(handles if handles is not None else axes.get_legend_handles_labels()[1])
    axes.legend(
        **named,
        ncols=2 if count > 6 else 1,
        columnspacing=1.0,
        title=title or None,
        loc="upper left",
        bbox_to_anchor=(1.005, 1.02),
    )


def legend_below(picture: Any, all_axes: Sequence[Any]) -> None:
    """Add one legend for the curves of all axes below them."""
    named = {label: handle for axes in all_axes for handle, label in zip(*axes.get_legend_handles_labels())}
    picture.legend(named.values(), named.keys(), loc="outside lower center", ncols=min(len(named), 4))


def stacked(picture: Any, count: int) -> list[Any]:
    """Add `count` axes below each other, which share the X axis."""
    axes = [picture.add_subplot(count, 1, 1)]
    axes += [picture.add_subplot(count, 1, n, sharex=axes[0]) for n in range(2, count + 1)]
    return axes


def panels(count: int, title: str, each: tuple[float, float] = (3.4, 2.6)) -> tuple[Any, Sequence[Any]]:
    """Make a figure of `count` axes in up to four columns."""
    columns = min(4, max(1, round(count**0.5 + 0.2)))
    rows = -(-count // columns)
    picture = figure(each[0] * columns + 0.4, each[1] * rows + 0.5, title)
    axes = [picture.add_subplot(rows, columns, n + 1) for n in range(count)]
    for panel in axes:
        panel.locator_params(nbins=4)  # numbers that do not run into each other
    return picture, axes


def patches(named: Sequence[tuple[str, str]]) -> list[Any]:
    """Coloured discs for a legend, by their (colour, name)."""
    from matplotlib.lines import Line2D

    look = {"linestyle": "", "marker": "o", "markersize": 7, "markeredgecolor": "0.2"}
    return [Line2D([], [], color=c, label=name, **look) for c, name in named]  # type: ignore[arg-type]


def arrange(picture: Any) -> None:
    """Fix the final positions of all axes.

    The layout's last digits differ from run to run, and bytes would with them: they are rounded off.
    """
    literal(picture)  # a layout measures its texts
    picture.draw_without_rendering()
    places = [(axes, axes.get_position(original=True)) for axes in picture.axes]
    picture.set_layout_engine("none")
    for axes, box in places:
        axes.set_position([round(value, 6) for value in box.bounds])
    picture.draw_without_rendering()  # equal scales move the axes again


def text_box(text: Any) -> Any:
    """Corners of a drawn text in pixels, without the line to its point: x0, y0, x1, y1."""
    from matplotlib.text import Text

    text.get_window_extent()  # moves it to its place
    return Text.get_window_extent(text).extents


def save(picture: Any, path: Path) -> None:
    """Write a picture in the format of the path's ending; equal numbers give equal bytes."""
    import matplotlib

    literal(picture)
    with matplotlib.rc_context({"svg.hashsalt": "pound-solve", "svg.fonttype": "none"}):
        dated = {"Date": None} if path.suffix == ".svg" else None
        if path.suffix == ".pdf":
            dated = {"CreationDate": None}
        memory = BytesIO()  # a format whose writing fails may raise other errors than the system's
        picture.savefig(memory, format=path.suffix[1:], metadata=dated)
    write(path, memory.getbuffer())


def film(picture: Any, show: Callable[[int], None], count: int, path: Path, rate: int) -> None:
    """Write `count` frames, which `show` draws one by one, at `rate` a second into a .gif or .mp4.

    Raises
    ------
    ChoiceError
        There is no program that writes this format.
    OSError
        The file cannot be written.
    """
    from matplotlib.animation import writers

    name, need = ("pillow", "Pillow") if path.suffix == ".gif" else ("ffmpeg", "the program ffmpeg")
    if not writers.is_available(name):
        raise ChoiceError(f"{path.suffix} needs {need}, which is not installed: html needs nothing")
    literal(picture)
    writer = writers[name](fps=rate)
    try:
        with whole(path) as partial, writer.saving(picture, str(partial), dpi=100):
            for k in range(count):
                show(k)
                writer.grab_frame()
    except CalledProcessError as err:
        said = (err.stderr.strip().splitlines() or [f"{need} ended with status {err.returncode}"])[-1]
        raise OSError(errno.EIO, said, str(path)) from err


def literal(picture: Any) -> None:
    """Draw texts as they are, without formulas between dollar signs but for numbers of logarithmic axes."""
    from matplotlib.text import Text

    for text in picture.findobj(Text):
        text.set_parse_math(False)
    for axis in (axis for axes in picture.axes for axis in (axes.xaxis, axes.yaxis)):
        if axis.get_scale() == "log":
            for label in axis.get_ticklabels(which="both"):
                label.set_parse_math(True)
