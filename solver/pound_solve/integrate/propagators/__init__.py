"""The exact motion of a linear subsystem: its first-order form and its propagators."""
