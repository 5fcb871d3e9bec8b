"""Tracing with a bar: what ``run`` and ``scene --preview`` begin with."""

from __future__ import annotations

from simmpp.commands.terminal import notice, progress_bars
from simmpp.scene.scene import Scene
from simmpp.workload.picture import Picture
from simmpp.workload.store import workload_for
from simmpp.workload.workload import Workload


def traced(scene: Scene, picture: Picture) -> Workload:
    """The picture's workload, from the cache or traced with a bar."""
    with progress_bars() as bars:
        bar = bars.add_task("tracing rays", total=None)
        return workload_for(
            scene,
            picture,
            progress=lambda done, total: bars.update(bar, completed=done, total=total),
            notice=notice,
        )
