"""Assessment of methods, laws and decks."""
