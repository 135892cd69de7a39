"""Version of the program, in its own module so that every package may import it."""

__version__ = "0.3.0"
