"""Texts of models changed at random."""

from __future__ import annotations

import random
from collections.abc import Callable


def damaged(text: str, rng: random.Random, another: Callable[[str], str], gap: str = " ") -> str:
    """Text with one to six changes of lines, words, which stand `gap` apart, or characters.

    `another` makes a word that replaces the given one or stands beside it.
    """
    lines = text.split("\n")
    for _ in range(rng.choice((1, 1, 2, 3, 6))):
        k = rng.randrange(len(lines))
        words = lines[k].split(gap)
        at = rng.randrange(len(words))
        match rng.randrange(9):
            case 0:
                lines.insert(k, lines[rng.randrange(len(lines))])
            case 1:
                words[at] = another(words[at])
                lines[k] = gap.join(words)
            case 2:
                del words[at]
                lines[k] = gap.join(words)
            case 3:
                words.insert(at, another(words[at]))
                lines[k] = gap.join(words)
            case 4:
                lines[k] = lines[k][: rng.randrange(len(lines[k]) + 1)]
            case 5:
                at = rng.randrange(len(lines[k]) + 1)
                lines[k] = lines[k][:at] + chr(rng.randrange(1, 256)) + lines[k][at + 1 :]
            case 6:
                other = rng.randrange(len(lines))
                lines[k], lines[other] = lines[other], lines[k]
            case 7:
                del lines[k]
            case _:
                lines = lines[: k + 1]
        lines = lines or [""]
    return "\n".join(lines)
