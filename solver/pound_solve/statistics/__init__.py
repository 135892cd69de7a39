"""Statistics of many runs: curves over the level, fractiles, fragilities, separations."""
