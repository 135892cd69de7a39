"""Contact laws, one per file."""
