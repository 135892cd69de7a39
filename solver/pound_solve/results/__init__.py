"""Results files: contents, writer and reader."""

from pound_solve.results.form import ResultsError
from pound_solve.results.reader import Results, is_hdf5
from pound_solve.results.writer import Writer

__all__ = ("Results", "ResultsError", "Writer", "is_hdf5")
