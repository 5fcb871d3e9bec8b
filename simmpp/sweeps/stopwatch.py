"""How long one task takes, on the clock and on the processor."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TypeVar

from simmpp.errors import SimmppError

Made = TypeVar("Made")


class TimedOut(SimmppError):
    """A point took longer than it may."""


@dataclass(frozen=True)
class Seconds:
    """A span of time."""

    wall: float
    cpu: float
    """Of this thread."""

    def __add__(self, other: Seconds) -> Seconds:
        return Seconds(self.wall + other.wall, self.cpu + other.cpu)

    def __sub__(self, other: Seconds) -> Seconds:
        return Seconds(self.wall - other.wall, self.cpu - other.cpu)


def now() -> Seconds:
    """Since some moment that is always the same."""
    return Seconds(time.perf_counter(), time.thread_time())


class Stopwatch:
    """Times one task; what it shares with others counts whoever made it."""

    def __init__(self, timeout_s: float | None) -> None:
        self._timeout_s, self._began, self._shared = timeout_s, now(), Seconds(0.0, 0.0)

    def count(self, shared: tuple[Made, Seconds]) -> Made:
        """Take something with the seconds that it took: the rest begins here."""
        made, self._shared = shared
        self._began = now()
        return made

    @property
    def seconds(self) -> Seconds:
        """What was shared and the rest."""
        return self._shared + (now() - self._began)

    def look(self, rays_left: int) -> None:
        """Raise TimedOut if it is time."""
        if self._timeout_s is not None and self.seconds.wall > self._timeout_s:
            raise TimedOut(f"timeout: not finished after {self._timeout_s:g} s")
