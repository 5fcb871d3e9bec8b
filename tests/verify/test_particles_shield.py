"""Kobayashi's problem 1 without scattering: published fluxes, quadrature, and particles.

Source: Kobayashi, Sugimura and Nagaya 2001, "3D radiation transport benchmark problems and results
for simple geometries with void region", Progress in Nuclear Energy 39, problem 1 (i). The values
were written down from memory; the quadrature here, which knows none of them, gives each digit.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from particle_cells import preset

from simmpp.workload.particles.grid import ONE
from simmpp.workload.particles.results import table_of
from simmpp.workload.particles.settings import Particles
from simmpp.workload.ray_source import Columns

PUBLISHED = {15: 1.37185, 25: 0.500871, 35: 0.252429, 45: 0.150260, 55: 0.0595286, 65: 0.0153283}
"""At (5, y, 5) cm, of one particle a second and cm3 of the source."""
CUBES = ((10.0, 0.1), (50.0, 0.0001), (100.0, 0.1))
"""About the origin, as mirrors show them: half an edge, and sigma_t as far as the cube before."""
COUNT = 200_000
Points = NDArray[np.float64]


def cube(low: float | Points, high: float | Points, n: int) -> tuple[Points, Points]:
    """Gauss's points in a cube, and their weights."""
    x, w = np.polynomial.legendre.leggauss(n)
    unit = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1).reshape(-1, 3)
    weights = np.multiply.outer(np.multiply.outer(w, w), w).ravel()
    return (low + high) / 2 + unit * (high - low) / 2, weights * np.prod(high - low) / 8


def depth(a: Points, b: Points) -> Points:
    """Optical depth between points (n, 3) each."""
    length, inside, depths = np.linalg.norm(b - a, axis=1), np.zeros(len(a)), np.zeros(len(a))
    for half, sigma in CUBES:
        planes = np.sort((np.array([[[-half]], [[half]]]) - a) / (b - a), axis=0)
        enters, leaves = planes[0].max(axis=1), planes[1].min(axis=1)
        chord = np.maximum(0.0, np.minimum(leaves, 1.0) - np.maximum(enters, 0.0)) * length
        depths += sigma * (chord - inside)
        inside = chord
    return depths


def flux(at: Points, n: int) -> float:
    """Uncollided flux at a point, by quadrature over the source."""
    source, weights = cube(np.full(3, -10.0), np.full(3, 10.0), n)
    points = np.broadcast_to(at, source.shape)
    square = ((source - points) ** 2).sum(axis=1)
    return float((weights * np.exp(-depth(source, points)) / (4 * math.pi * square)).sum())


@pytest.mark.parametrize("y", PUBLISHED)
def test_quadrature_is_what_was_published(y: int) -> None:
    assert flux(np.array([5.0, y, 5.0]), 32) == pytest.approx(PUBLISHED[y], rel=5e-6)


@pytest.fixture(scope="module")
def table() -> Columns:
    absorbing = {"albedo": 0}
    cells = preset("shield", materials={"void": absorbing, "shield": absorbing})
    return table_of(cells, Particles(count=COUNT))


@pytest.mark.parametrize("y", PUBLISHED)
def test_particles_are_what_quadrature_is(y: int, table: Columns) -> None:
    """In the cells about (5, y, 5), (y, 5, 5) and (5, 5, y), 10 cm wide; within 4 errors."""
    points, weights = cube(np.array([0.0, y - 5, 0.0]), np.array([10.0, y + 5, 10.0]), 3)
    of_points = np.array([flux(point, 8) for point in points])
    expected = (weights * of_points).sum() / weights.sum()
    there = y // 10 * np.array([1, 10, 100])
    obtained = table["flux"][there] * 1000  # as many particles begin each second in 1000 cm3
    errors = table["flux_error"][there] * 1000
    assert (np.abs(obtained - expected) < 4 * errors).all()
    assert abs(obtained.mean() - expected) < 4 * math.sqrt((errors**2).sum()) / 3


def test_a_table_is_of_whole_sums(table: Columns) -> None:
    assert table["absorbed"].sum() == pytest.approx(table["absorbed_sum"].sum() / ONE / COUNT)
    assert table["visits"].sum() > COUNT
    seen = table["absorbed_sum"] > 0
    worst = (table["absorbed_error"][seen] / table["absorbed"][seen]).max()
    assert worst <= 1.0  # that of a cell in which one particle ended
