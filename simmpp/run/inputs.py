"""The workload of a configuration, and where processes that share it find it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from simmpp.common.errors import WorkloadError
from simmpp.config.config import Config
from simmpp.workload.cache.store import cached_path, load, save
from simmpp.workload.trace.tracer import Progress
from simmpp.workload.workload import Workload


def workload_of(
    config: Config,
    *,
    progress: Progress | None = None,
    notice: Callable[[str], None] | None = None,
) -> Workload:
    """The workload that the configuration's scene names, from the cache if it was traced before.

    Raises ConfigError, SceneError or WorkloadError for a scene or a file that is none.
    """
    return config.ray_source.workload(config.picture, progress, notice)


def cache_workload(
    config: Config,
    digest: str,
    *,
    progress: Progress | None = None,
    notice: Callable[[str], None] | None = None,
) -> Workload | None:
    """See to it that the workload of that digest is in the cache, from where processes share it.

    Returns it if it had to be made, None if it was there.
    """
    path = cached_path(digest)
    if path.exists():
        return None
    workload = workload_of(config, progress=progress, notice=notice)
    if not path.exists():  # nothing traced, or the cache can't be written
        with contextlib.suppress(OSError):  # then each worker makes or reads it itself
            path.parent.mkdir(parents=True, exist_ok=True)
            save(workload, path)
    return workload


def shared_workload(config: Config, digest: str) -> Workload:
    """The workload of that digest, from the cache by sharing its pages, or else made here.

    Raises WorkloadError if the scene here is another.
    """
    path = cached_path(digest)
    if path.exists():
        with contextlib.suppress(WorkloadError):  # damaged: made again
            workload = load(path)
            if workload.digest == digest:
                return workload
    workload = workload_of(config, notice=lambda text: None)
    if workload.digest != digest:
        raise WorkloadError(f"{workload.name} is another scene on this worker")
    return workload
