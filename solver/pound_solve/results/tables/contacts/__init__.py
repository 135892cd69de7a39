"""Section 'Contacts and collisions' of the report."""

from pound_solve.results.schema import Section

SECTION = Section("Contacts and collisions", 40)
