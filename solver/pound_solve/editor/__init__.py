"""Editor support for decks: a module for each kind of help, and `server`, which speaks the protocol.

Places are :class:`~pound_deck.model.Span` throughout; only `server` knows the editor's protocol.
"""
