"""Help for a deck in an editor: a module for each kind of help, and `server`, which speaks with the editor.

Places are :class:`~pound_deck.model.Span` throughout; only `server` knows the editor's protocol.
"""
