"""Endings of pictures; a module of its own, since the command line reads them before anything is drawn."""

from __future__ import annotations

from typing import Final

IMAGE_FORMATS: Final = ("svg", "png", "pdf")  #: of pictures that stand still, by matplotlib
ANIMATION_FORMATS: Final = ("html", "gif", "mp4")  #: of pictures that move
