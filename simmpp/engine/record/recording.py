"""What is noted of a run besides its totals."""

from __future__ import annotations

from dataclasses import dataclass

from simmpp.common.documented import documented
from simmpp.engine.record.log import Sink


@documented
@dataclass(frozen=True)
class Recording:
    """What a run notes down besides its totals; nothing by default."""

    log: bool | Sink = False
    """True keeps the event log in the result; a function gets its rows, (n,) EVENT, as they become
    final, and nothing is kept."""
    tests: bool = False
    """The (ray, object) pairs that PEs tested."""
    counters: bool = False
    """What pictures are made of: what happened when, and who sent how much to whom."""
    hops: bool = False
    """The links that were crossed for each ray."""
    ends: bool = False
    """When each ray was finished."""

    @property
    def sink(self) -> Sink | None:
        """The function that gets the event log."""
        return self.log if callable(self.log) else None


NOTHING = Recording()
