"""Print the notes of a release, from the changelog: ``python .github/release.py v1.2.3``.

It fails if the tag is not the version of the program, or if the changelog has no date for that version.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
VERSION = ROOT / "solver/pound_solve/version.py"


def notes(tag: str, version: str, changelog: str) -> str:
    """The part of the changelog on a version.

    Parameters
    ----------
    tag : str
        Of the release.
    version : str
        Of the program.
    changelog : str

    Raises
    ------
    ValueError
        Tag, version and changelog do not agree.
    """
    if tag != f"v{version}":
        raise ValueError(f"the tag is {tag}, the version is {version}")
    for part in changelog.split("\n## ")[1:]:
        heading, _, text = part.partition("\n")
        if re.fullmatch(rf"{re.escape(version)} - \d{{4}}-\d\d-\d\d", heading):
            return text.strip()
    raise ValueError(f"CHANGELOG.md has no heading with {version} and its date")


if __name__ == "__main__":
    (current,) = re.findall(r'^__version__ = "(.+)"', VERSION.read_text("utf-8"), re.M)
    print(notes(sys.argv[1], current, (ROOT / "CHANGELOG.md").read_text("utf-8")))
