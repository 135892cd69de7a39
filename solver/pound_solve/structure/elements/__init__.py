"""Elements: frame members, springs, dashpots and contacts, one kind per file."""
