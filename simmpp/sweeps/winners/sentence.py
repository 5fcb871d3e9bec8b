"""Something that points of a sweep say, in words."""

from __future__ import annotations

from typing import NamedTuple


class Sentence(NamedTuple):
    """A sentence, and the points that say so."""

    text: str
    points: tuple[int, ...] = ()
    """Their numbers."""
