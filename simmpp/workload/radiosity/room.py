"""Patches as rays see them, and the name of all that makes their rays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.code.source import source_digest
from simmpp.common.errors import SceneError
from simmpp.common.modules import RADIOSITY
from simmpp.scene.scene import Scene
from simmpp.workload.digest import hashed, parts_of_geometry
from simmpp.workload.radiosity.patches import Patches, patches_of
from simmpp.workload.radiosity.points import landed, leaving
from simmpp.workload.radiosity.settings import GATHERING, Radiosity
from simmpp.workload.trace.frame import Frame, frame_of
from simmpp.workload.trace.geometry import Geometry, flatten
from simmpp.workload.trace.ray_batch import RayBatch

Ints = NDArray[np.int64]


class Room(NamedTuple):
    """The patches of a scene, N of them with 2 N sides."""

    patches: Patches
    frame: Frame
    geometry: Geometry
    settings: Radiosity

    @property
    def name(self) -> str:
        """The scene's."""
        return self.patches.scene.name

    @property
    def n_sides(self) -> int:
        """2 N."""
        return 2 * len(self.patches.areas)

    @property
    def digest(self) -> str:
        """Hexadecimal SHA-256 of all that makes the rays; how much shines, where power decides."""
        told = sorted(item for item in vars(self.settings).items() if item[0] != "resolution")
        parts = [memoryview(repr((source_digest(RADIOSITY), told)).encode())]
        of_power = [self.patches.emitted, self.patches.reflectance]
        decide = [self.patches.emitted > 0] if self.settings.method == GATHERING else of_power
        parts += [column.data for column in decide]
        return hashed([*parts, *parts_of_geometry(self.patches.scene)])

    def leaving(self, sides: Ints, counts: Ints, shots: Ints) -> RayBatch:
        """So many rays of each side, each the shot of that number."""
        return leaving(self.geometry, sides, counts, shots, self.settings.seed)

    def landed(self, rays: RayBatch, hits: NDArray[np.int32]) -> Ints:
        """(n,) int64: the side that each ray lands on; -1 for none."""
        return landed(self.geometry, rays, hits)

    def endless(self) -> SceneError:
        """What to raise for light that never ends."""
        problem = "light never ends: patches reflect all of it, and it can't get out"
        expected = "expected a reflectance below 1, or an opening"
        return SceneError(f"{problem}: {expected}", where=self.name)


def room_of(scene: Scene, settings: Radiosity) -> Room:
    """The patches of a scene; raises as :func:`patches_of` does."""
    patches = patches_of(scene, settings)
    frame = frame_of(patches.scene)
    return Room(patches, frame, flatten(patches.scene, frame), settings)
