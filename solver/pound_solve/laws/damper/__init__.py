"""Laws of dampers, one law a file."""
