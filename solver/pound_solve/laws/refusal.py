"""How laws, elements and damping refuse the values of a card."""

from __future__ import annotations


class ItemError(ValueError):
    """An item has a value that contradicts another one, or what the law needs.

    Parameters
    ----------
    message : str
        What is wrong, and what would be right.
    item : str
        Name of the item at fault, whose place the message states; empty for the card.
    """

    def __init__(self, message: str, item: str = "") -> None:
        super().__init__(message)
        self.item = item
