"""The pictures of a results file: one module for each, found by `pound_solve.report.plot.catalog`."""
