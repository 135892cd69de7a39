"""Highlighting of decks for editors: words of the catalog, in the format of each editor."""
