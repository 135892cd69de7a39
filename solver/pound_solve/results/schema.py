"""Classes that declare the tables and histories of a results file.

Units are dimensions of the deck's own units (``F``, ``L``, ``T``, ``rad``, ``%``; ``-`` a pure number,
empty for no unit); :meth:`pound_deck.model.Units.text` turns them into the deck's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from enum import Enum, auto
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Generic, NamedTuple, TypeAlias, TypeVar

if TYPE_CHECKING:
    from pound_solve.analyses.recorder import RecordedItems, SampleBlock
    from pound_solve.numerics.types import Array

Record = TypeVar("Record")  #: source of a table's rows
Row: TypeAlias = tuple[Any, ...]  #: one value for each column

FORMATS: Final = MappingProxyType(
    {
        "int": "int64",
        "text": "text",
        "count": "float64",
        "time": "float64",
        "given": "float64",
        "num": "float64",
        "short": "float64",
        "percent": "float64",
    }
)  #: print format and storage type of a column


class Stage(Enum):
    """Points of a run, and the study, at which tables are written."""

    INPUT = auto()  #: the structure is assembled, nothing is computed yet
    STATIC = auto()  #: after a STATIC analysis
    MODAL = auto()  #: after a MODAL analysis
    PUSHOVER = auto()  #: after a PUSHOVER analysis
    HISTORY = auto()  #: after a HISTORY, even if it stopped immediately
    SAMPLES = auto()  #: after a HISTORY that has at least one sample
    PEAKS = auto()  #: after a HISTORY whose method returned its peaks
    END = auto()  #: the run is over or has stopped
    EXPLAIN = auto()  #: the same, if ``--explain`` is given
    STUDY = auto()  #: a study of all methods is complete


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table.

    Parameters
    ----------
    name : str
        Field of the compound dataset.
    head : str
        Head in the report; its line breaks are kept.  Empty: the name.
    unit : str
        Dimensions, see the module's head.
    fmt : str
        One of `FORMATS`: ``count`` is a whole number or NaN, ``time`` shows up to six decimals, ``given``
        all the digits that the deck gives (ten at most), ``num`` five significant digits, ``short`` four,
        ``percent`` two decimals.
    doc : str
        Meaning of the column, for the manual.
    zero : str
        Replacement that the report prints for 0 in an ``int`` column where 0 is not a count.
    clip : int
        Number of characters of a text that the report prints; 0 for all.
    """

    name: str
    head: str = ""
    unit: str = ""
    fmt: str = "text"
    doc: str = ""
    zero: str = ""
    clip: int = 0

    @property
    def is_text(self) -> bool:
        """Whether the column holds text."""
        return self.fmt == "text"

    @property
    def title(self) -> str:
        """Head of the column, which may have several lines."""
        return self.head or self.name.replace("_", " ")


@dataclass(frozen=True, slots=True)
class Section:
    """One section of the report: a folder of `pound_solve.results.tables`.

    Parameters
    ----------
    heading : str
        The report prints it in capitals.
    place : int
        Sections are ordered by place; steps of ten leave room for new ones.
    of_the_day : bool
        Its tables differ between two runs of the same deck.
    keeps_long : bool
        Its long tables stay in it; those of other sections move to the appendix of the report.
    """

    heading: str
    place: int
    of_the_day: bool = False
    keeps_long: bool = False


def no_remark(record: object) -> None:
    """Make no remark on a table."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sheet:
    """Columns with notes, which suffice to print rows that no file stores.

    Parameters
    ----------
    columns : tuple of Column
        In the order of storing and printing.
    note : str
        A sentence or two of explanation.
    group : str
        Column by whose values the report sorts rows into blocks (order within a block is kept), each with
        number formats of its own; empty for one block.
    """

    columns: tuple[Column, ...]
    note: str = ""
    group: str = ""

    @property
    def kinds(self) -> list[tuple[str, str]]:
        """Name and type of each column in memory, where texts are objects."""
        return [(c.name, "O" if c.is_text else FORMATS[c.fmt]) for c in self.columns]


@dataclass(frozen=True, slots=True, kw_only=True)
class Table(Sheet, Generic[Record]):
    """One table of the results file and of the report.

    Parameters
    ----------
    name : str
        Dataset below ``/tables``.
    title : str
        Heading; the report prints it in capitals.
    place : int
        Tables in a section are ordered by place; steps of ten leave room for new ones.
    stages : tuple of Stage
        When the table is written; a later stage replaces an earlier one.
    rows : callable
        Makes the rows from the record of the run (`RunRecord`) or of the study: one value for each column,
        in units of the deck, percentages as percent.  None leaves the table out.
    remark : callable
        Makes a remark on this run's table from the same record; the report prints it below the note.
    limit : int
        Largest number of rows that the report prints; 0 for all.
    """

    name: str
    title: str
    place: int
    stages: tuple[Stage, ...]
    rows: Callable[[Record], Iterable[Row] | None]
    remark: Callable[[Record], str | None] = no_remark
    limit: int = 0


class HistoryLayout(NamedTuple):
    """Shape of one row (one instant) of a history, and the attributes of its dataset.

    ``unit`` gives dimensions (``F*L``), one for all or one for each column of the last axis; ``labels``
    gives one text for each column of the last axis, by default made of ``element`` and ``quantity``.  A row
    with a first axis of nodes has their numbers in ``nodes``.
    """

    shape: tuple[int, ...]
    attributes: Mapping[str, Any]


#: Layout of each history by its name.
Layout: TypeAlias = Mapping[str, HistoryLayout]


@dataclass(frozen=True, slots=True, kw_only=True)
class History:
    """One dataset below ``/history``.

    Parameters
    ----------
    name : str
        Path below ``/history``.
    place : int
        Histories are ordered by place; steps of ten leave room for new ones.
    row : str
        Contents of one row (one instant), for the manual.
    doc : str
        Meaning of the numbers, for the manual.
    layout : callable
        Makes the layout from the recorded items.  A history with an empty row is not stored.
    values : callable
        Makes the rows, shape (n_times, \\*row), from a block of samples.
    closeup : bool
        Whether close-ups of collisions include it.
    extremes : bool
        Whether its smallest and largest values within intervals are stored.  `values` then also gets the
        extremes of nodes, laws, outputs and sums as if they were samples: it may select and order them, but
        must not add them up.
    axes : mapping of str to str
        Axes of a row (``node``, ``member``, ``component``, ...), each with the attribute that holds its
        labels. Without axes only `labels` identify a column. The histories of a group share their axes: an
        axis of one name has the same labels in all of them, and no group has the name of an axis.
    """

    name: str
    place: int
    row: str
    doc: str
    layout: Callable[[RecordedItems], HistoryLayout]
    values: Callable[[SampleBlock], Array]
    closeup: bool = False
    extremes: bool = False
    axes: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
