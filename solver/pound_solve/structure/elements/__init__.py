"""Elements: frame members, springs, dashpots and contacts, one kind a file."""
