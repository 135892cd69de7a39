"""Run the command line with ``python -m pound_solve``."""

from pound_solve.cli import main

raise SystemExit(main())
