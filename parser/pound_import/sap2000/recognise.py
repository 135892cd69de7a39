"""Whether a text is a model of SAP2000: lines ``TABLE:  "NAME"``, of which its decks have none."""

from __future__ import annotations

import re
from typing import Final

HEAD: Final = 20_000  #: characters examined
_TABLE: Final = re.compile(r'^\s*TABLE\s*:\s*"[^"\n]+"\s*$', re.M | re.I)


def is_sap2000(text: str) -> bool:
    """Whether a text is a model of SAP2000, judged by its first lines."""
    return _TABLE.search(text[:HEAD]) is not None
