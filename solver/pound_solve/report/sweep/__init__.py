"""Reports of sweeps in words, tables and what pictures show."""
