"""What particles leave in cells, as a table; and whether simulated PEs made all that they do."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.particles.cells import Cells
from simmpp.workload.particles.grid import ONE, Floats, Longs, grid_of
from simmpp.workload.particles.settings import Particles
from simmpp.workload.particles.tables import BEHIND
from simmpp.workload.particles.tracer import tallies, trace
from simmpp.workload.ray_source import Columns
from simmpp.workload.trace.verify import wrong_test
from simmpp.workload.workload import Workload

Ints = NDArray[np.int32]


def table_of(cells: Cells, particles: Particles) -> Columns:
    """A row for each cell: per particle, with the standard error of each mean.

    ``flux`` is track length over volume, ``absorbed`` a share of all weight, ``visits`` the number
    of segments. The sums that these are of stand beside them, whole numbers of 2^-32; tracks are in
    the cells' greatest width.
    """
    tally, grid, n = tallies(cells, particles), grid_of(cells), particles.count
    inside = slice(0, len(tally.absorbed) - BEHIND)
    per_flux = grid.unit / math.prod(grid.widths)
    flux, flux_error = _mean(tally.tracks[inside], tally.track_squares[inside], n)
    absorbed, error = _mean(tally.absorbed[inside], tally.absorbed_squares[inside], n)
    return {
        "object": np.arange(len(flux), dtype=np.int32),
        "flux": flux * per_flux,
        "flux_error": flux_error * per_flux,
        "absorbed": absorbed,
        "absorbed_error": error,
        "visits": tally.visits[inside],
        "track_sum": tally.tracks[inside],
        "track_squares": tally.track_squares[inside],
        "absorbed_sum": tally.absorbed[inside],
        "absorbed_squares": tally.absorbed_squares[inside],
    }


def _mean(sums: Longs, squares: Floats, n: int) -> tuple[Floats, Floats]:
    """Of ``n`` roots, and its standard error."""
    mean = sums / (ONE * n)
    variance = np.maximum(0.0, squares / (ONE * n) - mean * mean)
    return mean, np.sqrt(variance / n)


def problem_of(
    cells: Cells,
    particles: Particles,
    workload: Workload,
    tested_rays: Ints,
    tested_objects: Ints,
) -> str:
    """How tests differ from the segments of particles that are followed again; empty if not."""
    again = trace(cells, particles)
    for name in ("parents", "itinerary_offsets", "itinerary_objects", "hits", "test_deposits"):
        if not np.array_equal(getattr(again, name), getattr(workload, name)):
            return f"particles that are followed again have other {name}"
    _, problem = wrong_test(workload, tested_rays, tested_objects) or (0, "")
    return problem
