"""A sweep's tables while it runs, for those who watch it."""

from __future__ import annotations

import time
from collections.abc import Callable

SHOWN_S, SHARE = 5.0, 20
"""Seconds between two writings at least, and how many times as long as one writing takes."""


class Showing:
    """Writes the tables of a sweep that runs now and then, for those who watch it.

    At once, then every SHOWN_S seconds, or less often if writing takes more than a twentieth.
    """

    def __init__(self, write: Callable[[], None]) -> None:
        self._write = write
        write()  # takes its time to import, which is not counted
        self._next_s = time.monotonic() + SHOWN_S

    def __call__(self) -> None:
        """Write if it is time."""
        began_s = time.monotonic()
        if began_s >= self._next_s:
            self._write()
            ended_s = time.monotonic()
            self._next_s = ended_s + max(SHOWN_S, SHARE * (ended_s - began_s))
