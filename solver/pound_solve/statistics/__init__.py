"""What many runs say together: curves over the level, fractiles, fragilities, separations."""
