"""Where rays come from: a scene in which they are traced, or a file of another renderer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError
from simmpp.scene.scene import Origin, Scene
from simmpp.workload.picture import Picture

if TYPE_CHECKING:
    from simmpp.workload.trace.tracer import Progress
    from simmpp.workload.workload import Workload

Ints = NDArray[np.int32]
Flags = NDArray[np.bool_]
Image = NDArray[np.uint8]
Columns = dict[str, NDArray[Any]]
Notice = Callable[[str], None]
NO_GEOMETRY = "expected a scene to trace; a workload file has rays, but no geometry"

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

    @property
    def can_draw(self) -> bool:
        """What comes of the rays can be drawn, and verified."""

    def name_and_digest(self, picture: Picture) -> tuple[str, str]:
        """What the workload is called, and its digest, without tracing it."""

    def workload(
        self, picture: Picture, progress: Progress | None, notice: Notice | None
    ) -> Workload:
        """The workload; ``notice`` is told what of scene or cache is not as one might expect."""

    def draw(self, picture: Picture, workload: Workload, done: Flags | None = None) -> Image:
        """What comes of the rays, (rows, columns, 3) uint8; of the ``done`` roots (n0,) if given.

        Raises ConfigError where there is no geometry.
        """

    def verify(
        self, picture: Picture, workload: Workload, tested_rays: Ints, tested_objects: Ints
    ) -> str:
        """How what these tests give differs from what one processor makes; empty if it does not.

        Raises ConfigError where there is no geometry.
        """

    def results(self, workload: Workload) -> Columns | None:
        """What comes of the rays, a row for each object: columns by name; None if all is drawn."""


@dataclass(frozen=True)
class SceneSource:
    """Rays that are traced here, in a scene."""

    scene: Callable[[], Scene]
    has_own_picture: bool = False
    can_draw: bool = True

    def name_and_digest(self, picture: Picture) -> tuple[str, str]:
        """The scene's name; the digest of all that the tracer would read."""
        from simmpp.workload.digest import digest_of

        scene = self.scene()
        return scene.name, digest_of(scene, picture)

    def workload(
        self, picture: Picture, progress: Progress | None, notice: Notice | None
    ) -> Workload:
        """From the cache if it was traced before."""
        from simmpp.workload.cache.store import workload_for

        scene = self.scene()
        if notice:
            for line in told(scene):
                notice(line)
        return workload_for(scene, picture, progress=progress, notice=notice)

    def draw(self, picture: Picture, workload: Workload, done: Flags | None = None) -> Image:
        """The picture."""
        from simmpp.workload.trace.shading import render

        return render(self.scene(), picture, workload, done)

    def verify(
        self, picture: Picture, workload: Workload, tested_rays: Ints, tested_objects: Ints
    ) -> str:
        """The first difference between the pictures, or between the tests."""
        from simmpp.workload.trace.verify import verify

        return str(verify(self.scene(), picture, workload, tested_rays, tested_objects) or "")

    def results(self, workload: Workload) -> Columns | None:
        """None: a picture is all there is."""
        return None


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
    can_draw: bool = False

    def name_and_digest(self, picture: Picture) -> tuple[str, str]:
        """The file's stem; the digest of what the file holds, which has to be read for it."""
        workload = self.workload(picture, None, None)
        return workload.name, workload.digest

    def workload(
        self, picture: Picture, progress: Progress | None, notice: Notice | None
    ) -> Workload:
        """The file's; it says itself what its picture is."""
        from simmpp.workload.exchange.exchange import import_workload

        return import_workload(self.file)

    def draw(self, picture: Picture, workload: Workload, done: Flags | None = None) -> Image:
        """Refused."""
        raise ConfigError(NO_GEOMETRY, where=self.file)

    def verify(
        self, picture: Picture, workload: Workload, tested_rays: Ints, tested_objects: Ints
    ) -> str:
        """Refused."""
        raise ConfigError(NO_GEOMETRY, where=self.file)

    def results(self, workload: Workload) -> Columns | None:
        """None: what its rays are for is not known here."""
        return None
