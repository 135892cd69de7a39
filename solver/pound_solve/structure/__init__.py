"""The assembled structure: DOFs, elements, damping, geometry, reduction."""
