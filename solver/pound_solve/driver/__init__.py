"""One run from end to end: prepare, check, analyse, record."""
