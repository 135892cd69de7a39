"""Version of the program; stands alone, so that every room may name it."""

__version__ = "0.2.0"
