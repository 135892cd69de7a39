"""The base of all errors that a user can mend."""


class UserError(Exception):
    """What a user asked for cannot be done; the text says why, and what would help.

    Attributes
    ----------
    status : int
        Exit status of the command line: 2 for mistakes, 3 for files.
    has_places : bool
        Whether the text consists of messages with their places.
    """

    status, has_places = 2, False
