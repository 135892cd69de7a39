"""The histories of a results file: one module for each kind, found by `pound_solve.results.contents`."""
