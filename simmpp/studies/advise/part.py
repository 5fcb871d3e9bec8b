"""Where the rays are more than the machine that advises can hold: fewer pixels of the same view."""

from __future__ import annotations

from simmpp.config.config import Config, with_key
from simmpp.run.inputs import workload_of
from simmpp.studies.advise.running import Watcher
from simmpp.workload.room import NoRoom
from simmpp.workload.workload import Workload

LEAST_PIXELS = 16
"""Along a side: a smaller picture says nothing. ESTIMATE."""


def held_workload(config: Config, watcher: Watcher) -> tuple[Config, Workload, str]:
    """The rays, or those of every fourth pixel, or of every sixteenth ...; and what is left out.

    Raises NoRoom if there is no such picture.
    """
    told = ""
    while True:
        try:
            workload = workload_of(config, progress=watcher.tracing, notice=watcher.notice)
        except NoRoom as error:
            config, told = _smaller(config, error), told or str(error)
        else:
            return config, workload, _said(told, workload)


def _smaller(config: Config, error: NoRoom) -> Config:
    """With half as many pixels along each side."""
    resolution = config.picture.resolution
    sides = [resolution] * 2 if isinstance(resolution, int) else resolution
    if isinstance(sides, str) or min(sides) < 2 * LEAST_PIXELS:
        raise error
    return with_key(config, "picture.resolution", [side // 2 for side in sides])


def _said(told: str, workload: Workload) -> str:
    if not told:
        return ""
    columns, rows = workload.picture
    return (
        f"All rays are more than this machine can hold ({told}): the advice is of {columns} x"
        f" {rows} pixels of the same view. What fits and who is ahead is likely so with all; times"
        " are not theirs."
    )
