"""Rigid contacts: impacts, and closed contacts that press or part, for all methods that take them."""
