"""Where rays come from: a scene in which they are traced, or a file of another renderer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from simmpp.scene.scene import Origin, Scene
from simmpp.workload.picture import Picture

if TYPE_CHECKING:
    from simmpp.workload.trace.tracer import Progress
    from simmpp.workload.workload import Workload

# The tracer and the reader of tables are imported where they are called: with numba they take a
# second, and neither a checked configuration nor the list of a scene's objects needs them.


class RaySource(Protocol):
    """What a configuration asks of the place where its rays come from."""

    @property
    def scene(self) -> Callable[[], Scene] | None:
        """Makes the scene that is rendered; None where there are rays, but no geometry."""

    @property
    def has_own_picture(self) -> bool:
        """Which rays there are is settled, whatever the key ``picture`` says."""

    def name_and_digest(self, picture: Picture) -> tuple[str, str]:
        """What the workload is called, and its digest, without tracing it."""

    def workload(
        self, picture: Picture, progress: Progress | None, notice: Callable[[str], None] | None
    ) -> Workload:
        """The workload; ``notice`` is told what of scene or cache is not as one might expect."""


@dataclass(frozen=True)
class SceneSource:
    """Rays that are traced here, in a scene."""

    scene: Callable[[], Scene]
    has_own_picture: bool = False

    def name_and_digest(self, picture: Picture) -> tuple[str, str]:
        """The scene's name; the digest of all that the tracer would read."""
        from simmpp.workload.digest import digest_of

        scene = self.scene()
        return scene.name, digest_of(scene, picture)

    def workload(
        self, picture: Picture, progress: Progress | None, notice: Callable[[str], None] | None
    ) -> Workload:
        """From the cache if it was traced before."""
        from simmpp.workload.cache.store import workload_for

        scene = self.scene()
        if notice:
            for line in told(scene):
                notice(line)
        return workload_for(scene, picture, progress=progress, notice=notice)


def told(scene: Scene) -> list[str]:
    """The view of a scene that brings none, or another than its own, and what was not read."""
    origin = scene.origin
    view = [] if origin.view == Origin().view else [origin.view]
    return [f"{scene.name}: {line}" for line in (*view, *origin.notes)]


@dataclass(frozen=True)
class FileSource:
    """Rays that another renderer has written to a file."""

    file: str
    scene: None = None
    has_own_picture: bool = True

    def name_and_digest(self, picture: Picture) -> tuple[str, str]:
        """The file's stem; the digest of what the file holds, which has to be read for it."""
        workload = self.workload(picture, None, None)
        return workload.name, workload.digest

    def workload(
        self, picture: Picture, progress: Progress | None, notice: Callable[[str], None] | None
    ) -> Workload:
        """The file's; it says itself what its picture is."""
        from simmpp.workload.exchange.exchange import import_workload

        return import_workload(self.file)
