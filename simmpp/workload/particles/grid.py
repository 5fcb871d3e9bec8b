"""Cells, their source, and how particles are followed, as arrays for compiled code."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.particles.cells import SIDES, Box, Cells
from simmpp.workload.particles.settings import ROULETTE, Particles

Floats = NDArray[np.float64]
Longs = NDArray[np.int64]
ONE = 2**32
"""The weight 1: weights are whole numbers of 2^-32, so that sums of them have no order."""
EMITS = ("isotropic", "cosine", "beam")
ISOTROPIC, COSINE, BEAM = range(3)


class Grid(NamedTuple):
    """N cells, x fastest; M materials."""

    shape: tuple[int, int, int]
    widths: tuple[float, float, float]
    """Of a cell, along each axis."""
    unit: float
    """The greatest of them: tracks are counted in it, so that no segment is more than two."""
    materials: Floats
    """(M, 3) float64: sigma_t, albedo and g; the first one is empty space."""
    material_of: NDArray[np.uint8]
    """(N,) uint8."""
    importances: NDArray[np.int32]
    """(N,) int32."""
    mirrors: NDArray[np.bool_]
    """(6,) bool of each side."""
    corners: Floats
    """(3, 3) float64: of the source's box, the least and the greatest, and the direction."""
    emits: int


class Rules(NamedTuple):
    """How particles are followed."""

    seed: int
    implicit: bool
    splitting: bool
    least: int
    """Weight below which chance decides."""


def rules_of(particles: Particles) -> Rules:
    """Those of settings."""
    implicit = particles.capture == "implicit"
    return Rules(particles.seed, implicit, particles.splitting, int(ROULETTE * ONE))


def grid_of(cells: Cells) -> Grid:
    """The arrays of ``cells``."""
    shape, (x, y, z) = cells.shape, cells.size
    widths = x / shape[0], y / shape[1], z / shape[2]
    names, middles = list(cells.materials), _middles(shape, widths)
    rows = [(0.0, 0.0, 0.0), *((m.sigma_t, m.albedo, m.g) for m in cells.materials.values())]
    material_of = np.zeros(shape[::-1], np.uint8)
    importances = np.ones(shape[::-1], np.int32)
    for box in cells.boxes:
        inside = np.ix_(*_inside(box, middles)[::-1])
        material_of[inside] = 1 + names.index(box.material)
        importances[inside] = box.importance
    source = cells.source
    aim = np.array(source.towards) / np.abs(source.towards).max()  # so that no square is 0 or inf
    return Grid(
        shape=shape,
        widths=widths,
        unit=max(widths),
        materials=np.array(rows, np.float64),
        material_of=material_of.ravel(),
        importances=importances.ravel(),
        mirrors=np.array([side in cells.mirrors for side in SIDES]),
        corners=np.array([source.low, source.high or source.low, aim / np.sqrt((aim * aim).sum())]),
        emits=EMITS.index(source.emits),
    )


def centroids(grid: Grid) -> Floats:
    """(N, 3) float64: the centre of each cell."""
    z, y, x = np.meshgrid(*_middles(grid.shape, grid.widths)[::-1], indexing="ij")
    return np.stack([x, y, z], axis=-1).reshape(-1, 3)


def _middles(shape: Sequence[int], widths: Sequence[float]) -> list[Floats]:
    """Along each axis, the centres of cells."""
    return [
        (np.arange(n) + 0.5) * np.float64(width) for n, width in zip(shape, widths, strict=True)
    ]


def _inside(box: Box, middles: list[Floats]) -> list[Longs]:
    """Along each axis, the cells whose centres lie in a box."""
    corners = zip(middles, box.low, box.high, strict=True)
    return [np.flatnonzero((middle >= low) & (middle <= high)) for middle, low, high in corners]
