"""Step-by-step methods."""
