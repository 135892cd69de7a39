"""The results file: its schema, its writer, its reader."""
