"""Write the deck of a seed: ``python -m verification.generated SEED [--records FOLDER]``."""

from __future__ import annotations

import argparse
from pathlib import Path

from verification.generated.decks import deck


def main() -> None:
    """Print the deck."""
    parser = argparse.ArgumentParser(description="Print the deck of a seed.")
    parser.add_argument("seed", type=int)
    parser.add_argument("--records", type=Path, metavar="FOLDER", help="folder of record files")
    args = parser.parse_args()
    print(deck(args.seed, args.records), end="")


if __name__ == "__main__":
    main()
