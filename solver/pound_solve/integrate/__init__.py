"""Time integration: the exact event-driven method and step-by-step methods, one a file."""
