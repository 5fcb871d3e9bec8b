"""Tracing with a bar: what commands that need a workload begin with."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from simmpp.commands.parts.terminal import announce_compilation, notice, progress_bars
from simmpp.config.config import Config
from simmpp.run.inputs import workload_of
from simmpp.scene.scene import Scene
from simmpp.workload.cache.store import workload_for
from simmpp.workload.picture import Picture
from simmpp.workload.trace.tracer import Progress
from simmpp.workload.workload import Workload


def workload(config: Config, *, simulating: bool = False) -> Workload:
    """The workload that a configuration names; whatever must be traced is traced with a bar."""
    announce_compilation(simulating=simulating)
    with _bar() as progress:
        return workload_of(config, progress=progress, notice=notice)


def workload_of_scene(scene: Scene, picture: Picture) -> Workload:
    """The picture's workload, from the cache or traced with a bar."""
    announce_compilation(simulating=False)
    with _bar() as progress:
        return workload_for(scene, picture, progress=progress, notice=notice)


@contextmanager
def _bar() -> Iterator[Progress]:
    with progress_bars() as bars:
        bar = bars.add_task("tracing rays", total=None)
        yield lambda done, total: bars.update(bar, completed=done, total=total)
