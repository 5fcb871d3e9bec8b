"""The workload of a configuration: traced from a scene, or another renderer's."""

from __future__ import annotations

from collections.abc import Callable

from simmpp.scene.load import load_scene
from simmpp.sweep.config import Config
from simmpp.workload.exchange import import_workload
from simmpp.workload.store import workload_for
from simmpp.workload.tracer import Progress
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
