"""The verbs, one a module: ``SUMMARY``, ``add_arguments(parser)`` and ``execute(args)``.

The name of a module is that of its verb; `main` finds it.  It imports its dependencies on execution, so
that help and version need no numerics.
"""
