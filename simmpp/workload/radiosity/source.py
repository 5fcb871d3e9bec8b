"""Where rays between patches come from: a scene, and what is asked of its light."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from simmpp.scene.scene import Scene
from simmpp.workload.picture import Picture
from simmpp.workload.radiosity.patches import patches_of
from simmpp.workload.radiosity.settings import Radiosity
from simmpp.workload.ray_source import Columns, Flags, Image, Ints, told

if TYPE_CHECKING:
    from simmpp.workload.radiosity.room import Room
    from simmpp.workload.trace.tracer import Progress
    from simmpp.workload.workload import Workload

# What is compiled is imported where it is called, as in ray_source.


@dataclass(frozen=True)
class RadiositySource:
    """Rays between the patches of a scene; the key ``picture`` says nothing of them."""

    load: Callable[[], Scene]
    settings: Radiosity
    has_own_picture: bool = True
    can_draw: bool = True

    def scene(self) -> Scene:
        """The scene of patches."""
        return patches_of(self.load(), self.settings).scene

    def name_and_digest(self, picture: Picture) -> tuple[str, str]:
        """The scene's name; the digest of all that makes the rays."""
        room = self._room()
        return room.name, room.digest

    def workload(
        self, picture: Picture, progress: Progress | None, notice: Callable[[str], None] | None
    ) -> Workload:
        """From the cache if it was traced before."""
        from simmpp.workload.cache.store import kept
        from simmpp.workload.radiosity.tracing import trace_patches

        room = self._room()
        if notice:
            for line in told(room.patches.scene):
                notice(line)
        return kept(room.name, room.digest, partial(trace_patches, room, progress), notice)

    def draw(self, picture: Picture, workload: Workload, done: Flags | None = None) -> Image:
        """Patches as the camera sees them, each of one colour."""
        from simmpp.workload.radiosity.solution import drawn
        from simmpp.workload.radiosity.tracing import again

        room = self._room()
        return drawn(room, again(room, workload, done)[0].brightness)

    def verify(
        self, picture: Picture, workload: Workload, tested_rays: Ints, tested_objects: Ints
    ) -> str:
        """The first ray of which the tests find another hit, or other tests were made."""
        from simmpp.workload.radiosity.tracing import again
        from simmpp.workload.trace.ray_batch import joined
        from simmpp.workload.trace.verify import problem_of_roots

        room = self._room()
        rays, tests = joined(again(room, workload)[1]), (tested_rays, tested_objects)
        return problem_of_roots(workload, room.geometry, room.frame, rays, *tests)

    def results(self, workload: Workload) -> Columns:
        """How each patch looks."""
        from simmpp.workload.radiosity.solution import table_of
        from simmpp.workload.radiosity.tracing import again

        room = self._room()
        return table_of(room, workload, again(room, workload)[0].brightness)

    def _room(self) -> Room:
        from simmpp.workload.radiosity.room import room_of

        return room_of(self.load(), self.settings)
