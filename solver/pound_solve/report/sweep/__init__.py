"""Reports of sweeps: texts, tables, and the data of pictures."""
