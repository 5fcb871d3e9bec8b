"""Makes a workload of particles: cells are its objects, their segments what is tested."""

from __future__ import annotations

import numpy as np

from simmpp.common.code.source import source_digest
from simmpp.common.errors import ConfigError
from simmpp.workload.digest import hashed
from simmpp.workload.particles.cells import GROUP_BYTES, STATE_BYTES, Cells
from simmpp.workload.particles.follow import added, batch, empty_tally, follow
from simmpp.workload.particles.generations import joined
from simmpp.workload.particles.grid import Grid, Rules, centroids, grid_of, rules_of
from simmpp.workload.particles.settings import Particles
from simmpp.workload.particles.tables import Tables, Tally
from simmpp.workload.particles.walk import homes
from simmpp.workload.room import BYTES_PER_RAY, FEW, MOST_RAYS, refuse
from simmpp.workload.threads import mapping
from simmpp.workload.trace.tracer import Progress, pixels_of
from simmpp.workload.workload import MESH, PARTICLE, Workload, frozen

BYTES_PER_SEGMENT = 24
"""A cell and a track, twice while batches are joined."""
FIRST = (8, 8), (64, 2), (FEW, 1)
"""Particles from which the room for all is estimated, and by which factor it may be off."""
RESULT_BYTES = 24
"""Of a cell: a sum, a sum of squares, and a count."""


def digest_of(cells: Cells, particles: Particles) -> str:
    """Hexadecimal SHA-256 of all that decides where particles fly, and of the source of it."""
    said = source_digest(__name__), cells.groups, particles.count, rules_of(particles)
    grid = grid_of(cells)
    arrays = [part for part in grid if isinstance(part, np.ndarray)]
    rest = [part for part in grid if not isinstance(part, np.ndarray)]
    return hashed([memoryview(repr((said, rest)).encode()), *(array.data for array in arrays)])


def trace(
    cells: Cells,
    particles: Particles,
    progress: Progress | None = None,
    threads: int | None = None,
) -> Workload:
    """All particles with the cells of their segments; the same whatever the threads.

    Raises ConfigError for particles that take more memory than there is, or never end.
    """
    grid, rules, count = grid_of(cells), rules_of(particles), particles.count
    _require_room(grid, rules, count, cells.name)
    batches = []
    with mapping(threads) as run:
        for done, followed in follow(grid, rules, count, run):
            batches += followed.tables
            if progress:
                progress(done, count)
    return _workload(cells, particles, grid, batches)


def tallies(cells: Cells, particles: Particles, threads: int | None = None) -> Tally:
    """What all particles leave in each cell, what left by each side, what roulette took."""
    grid = grid_of(cells)
    tally = empty_tally(grid)
    with mapping(threads) as run:
        for _, followed in follow(grid, rules_of(particles), particles.count, run):
            added(tally, followed.tally)
    return tally


def _require_room(grid: Grid, rules: Rules, count: int, name: str) -> None:
    """Refuse what would not fit into memory, by the first particles, and clearly by fewer."""
    for few, clearly in FIRST:
        n = min(few, count)
        tables = batch(grid, rules, 0, n).tables
        n_rays = sum(len(each.hits) for each in tables) * count // n
        n_segments = sum(len(each.cells) for each in tables) * count // n
        if n_rays > clearly * MOST_RAYS:
            problem = f"{count} particles make about {n_rays} parts, expected at most {MOST_RAYS}"
            raise ConfigError(f"{problem}: fewer particles, or lower importances", where=name)
        size = n_rays * BYTES_PER_RAY + n_segments * BYTES_PER_SEGMENT
        refuse(size // clearly, f"{count} particles take at least", "fewer particles", name)


def _workload(cells: Cells, particles: Particles, grid: Grid, batches: list[Tables]) -> Workload:
    rays = joined(batches)
    n, n_cells, count = len(rays.hits), len(grid.material_of), particles.count
    n_children = np.bincount(rays.parents[rays.parents >= 0], minlength=n)
    return frozen(
        Workload(
            name=cells.name,
            digest=digest_of(cells, particles),
            picture=(count, 1),
            kinds=np.full(n, PARTICLE, np.uint8),
            parents=rays.parents,
            child_offsets=np.cumsum(np.insert(n_children, 0, count), dtype=np.int32),
            pixels=pixels_of(rays.parents),
            hits=rays.hits,
            hit_distances=rays.distances,
            itinerary_offsets=np.cumsum(np.insert(rays.n_tests, 0, 0), dtype=np.int64),
            itinerary_objects=rays.cells,
            object_kinds=np.full(n_cells, MESH, np.uint8),
            object_triangles=np.zeros(n_cells, np.int32),
            object_bytes=np.full(n_cells, STATE_BYTES + GROUP_BYTES * cells.groups, np.int64),
            object_centroids=centroids(grid),
            root_homes=homes(grid, particles.seed, count),
            object_results=np.full(n_cells, RESULT_BYTES, np.int64),
            test_deposits=rays.tracks,
        )
    )
