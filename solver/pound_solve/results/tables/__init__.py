"""The tables of a results file: a folder for each section of the report, a module for each table.

A new table is a new module that holds a `Table`; nothing lists it.  Its history, if it has one, may stand
in the same module as a `History`.
"""
