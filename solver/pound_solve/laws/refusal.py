"""The error that laws, elements and damping raise for invalid values of a card."""

from __future__ import annotations


class ItemError(ValueError):
    """The value of an item contradicts another value or the requirements of the law.

    Parameters
    ----------
    message : str
        What is wrong, and what would be valid.
    item : str
        Name of the invalid item, whose position the message gives; empty for the whole card.
    """

    def __init__(self, message: str, item: str = "") -> None:
        super().__init__(message)
        self.item = item
