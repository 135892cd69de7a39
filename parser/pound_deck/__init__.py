"""Read a pound-solve deck: text in, a checked :class:`~pound_deck.model.Model` out."""
