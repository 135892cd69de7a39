"""State and kernels that the stepping and the series methods share."""
