"""Texts of models changed at random."""

from __future__ import annotations

import random
from collections.abc import Sequence


def damaged(text: str, rng: random.Random, choices: Sequence[str]) -> str:
    """Text with one to six changes of lines, words, which may become one of the choices, or characters."""
    lines = text.split("\n")
    for _ in range(rng.choice((1, 1, 2, 3, 6))):
        k = rng.randrange(len(lines))
        words = lines[k].split(" ")
        match rng.randrange(8):
            case 0:
                lines.insert(k, lines[rng.randrange(len(lines))])
            case 1:
                words[rng.randrange(len(words))] = rng.choice(choices)
                lines[k] = " ".join(words)
            case 2:
                del words[rng.randrange(len(words))]
                lines[k] = " ".join(words)
            case 3:
                words.insert(rng.randrange(len(words) + 1), rng.choice(choices))
                lines[k] = " ".join(words)
            case 4:
                lines[k] = lines[k][: rng.randrange(len(lines[k]) + 1)]
            case 5:
                at = rng.randrange(len(lines[k]) + 1)
                lines[k] = lines[k][:at] + chr(rng.randrange(1, 256)) + lines[k][at + 1 :]
            case 6:
                other = rng.randrange(len(lines))
                lines[k], lines[other] = lines[other], lines[k]
            case _:
                lines = lines[: k + 1]
    return "\n".join(lines)
