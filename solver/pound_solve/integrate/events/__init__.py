"""Event location: three locators of the first rise of an event function."""
