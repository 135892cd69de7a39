"""Run the command line with ``python -m pound_solve``."""

from pound_solve.cli.main import main

raise SystemExit(main())
