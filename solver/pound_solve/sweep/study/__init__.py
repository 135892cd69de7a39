"""What a sweep is to run: the file of a study, its records, all of its runs, what is kept of each."""
