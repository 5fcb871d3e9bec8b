"""Where particles come from: cells with a source in them, and what is asked of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from simmpp.workload.particles.cells import Cells
from simmpp.workload.particles.settings import Particles
from simmpp.workload.picture import Picture
from simmpp.workload.ray_source import Columns, Flags, Image, Ints, Notice

if TYPE_CHECKING:
    from simmpp.workload.trace.tracer import Progress
    from simmpp.workload.workload import Workload

# What is compiled is imported where it is called, as in ray_source.


@dataclass(frozen=True)
class ParticleSource:
    """Particles that fly through cells; the key ``picture`` says nothing of them."""

    cells: Cells
    settings: Particles
    scene: None = None
    has_own_picture: bool = True
    can_draw: bool = True

    def name_and_digest(self, picture: Picture) -> tuple[str, str]:
        """The preset's name; the digest of all that decides where particles fly."""
        from simmpp.workload.particles.tracer import digest_of

        return self.cells.name, digest_of(self.cells, self.settings)

    def workload(
        self, picture: Picture, progress: Progress | None, notice: Notice | None
    ) -> Workload:
        """From the cache if they were followed before."""
        from simmpp.workload.cache.store import kept
        from simmpp.workload.particles.tracer import trace

        follow = partial(trace, self.cells, self.settings, progress)
        return kept(*self.name_and_digest(picture), follow, notice)

    def draw(self, picture: Picture, workload: Workload, done: Flags | None = None) -> Image:
        """How far particles flew in each cell of a layer."""
        from simmpp.workload.particles.map import drawn

        return drawn(self.cells, workload, done)

    def verify(
        self, picture: Picture, workload: Workload, tested_rays: Ints, tested_objects: Ints
    ) -> str:
        """The first particle with other segments than these tests, when all are followed again."""
        from simmpp.workload.particles.results import problem_of

        tests = tested_rays, tested_objects
        return problem_of(self.cells, self.settings, workload, *tests)

    def results(self, workload: Workload) -> Columns:
        """What particles leave in each cell."""
        from simmpp.workload.particles.results import table_of

        return table_of(self.cells, self.settings)
