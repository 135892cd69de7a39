"""Closed-form theory of colliding bars."""
