"""The base class of all errors that a user can correct."""


class UserError(Exception):
    """Raised if a request cannot be fulfilled; the message gives the reason and a remedy.

    Attributes
    ----------
    status : int
        Exit status of the command line: 2 for mistakes, 3 for files.
    has_places : bool
        Whether the message consists of diagnostics with their places.
    """

    status, has_places = 2, False
