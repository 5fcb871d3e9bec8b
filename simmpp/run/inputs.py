"""The workload of a configuration: traced from a scene, or another renderer's."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from simmpp.common.errors import WorkloadError
from simmpp.config.config import Config
from simmpp.scene.load import load_scene
from simmpp.workload.cache.store import cached_path, open_workload, save, workload_for
from simmpp.workload.digest import digest_of
from simmpp.workload.exchange.exchange import import_workload
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
    file = config.settings.scene.workload
    if file is not None:
        return import_workload(config.folder / file)
    scene = load_scene(config.scene_spec)
    return workload_for(scene, config.picture, progress=progress, notice=notice)


def name_and_digest(config: Config) -> tuple[str, str]:
    """What the workload of a configuration is called, and its digest, without tracing it."""
    file = config.settings.scene.workload
    if file is not None:
        workload = import_workload(config.folder / file)
        return workload.name, workload.digest
    scene = load_scene(config.scene_spec)
    return scene.name, digest_of(scene, config.picture)


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
    if config.settings.scene.workload is not None:
        with contextlib.suppress(OSError):  # then each worker reads the tables themselves
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
            workload = open_workload(path)
            if workload.digest == digest:
                return workload
    workload = workload_of(config, notice=lambda text: None)
    if workload.digest != digest:
        raise WorkloadError(f"{workload.name} is another scene on this worker")
    return workload
