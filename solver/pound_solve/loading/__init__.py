"""Actions on the structure: ground motions, forces in time, records."""
