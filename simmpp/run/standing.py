"""How far the sweep is whose ``run.json`` this is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from simmpp.common.units import counted
from simmpp.run.record import FAILED, FINISHED, SIMULATIONS


@dataclass(frozen=True)
class Standing:
    """What there is, of what there will be."""

    planned: int
    finished: int
    failed: int
    of: str = "simulation"
    """What is counted: simulations, or rows where nothing but these is known."""
    so_far: bool = False
    """More may be found to be needed."""

    @property
    def is_whole(self) -> bool:
        """Whether all is done, be it well or not."""
        return self.finished + self.failed >= self.planned

    @property
    def counts(self) -> str:
        """``"17 of 36 simulations"``."""
        so_far = " asked for so far" if self.so_far and not self.is_whole else ""
        return f"{self.finished + self.failed} of {counted(self.planned, self.of)}{so_far}"

    @property
    def progress(self) -> str:
        """``"17 of 36 simulations done, 2 failed"``."""
        return f"{self.counts} done" + (f", {self.failed} failed" if self.failed else "")


def recorded_standing(record: Mapping[str, Any]) -> Standing | None:
    """What a sweep's record says of it; None where it says nothing, as older ones."""
    planned, finished, failed = (record.get(key) for key in (SIMULATIONS, FINISHED, FAILED))
    if not (isinstance(planned, int) and isinstance(finished, int) and isinstance(failed, int)):
        return None
    config = record.get("config", {})
    so_far = any(config.get(key) for key in ("tolerance", "refine"))
    return Standing(planned, finished, failed, so_far=so_far)
