"""The command line: `main` reads it, and every module of `verbs` is one verb."""
