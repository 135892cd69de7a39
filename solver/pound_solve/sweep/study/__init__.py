"""Study of a sweep: its file, its records, all of its runs, and the quantities kept of each."""
