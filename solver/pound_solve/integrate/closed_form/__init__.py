"""Methods whose motion between events is known in closed form."""
