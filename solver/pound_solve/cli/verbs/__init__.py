"""The verbs, one a module: ``SUMMARY``, ``add_arguments(parser)`` and ``execute(args)``.

A module names its verb and is found by `main`.  It imports what it works with when it is executed: the help
and the version need no numerics.
"""
