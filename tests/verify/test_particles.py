"""Particles against closed forms and published tables: slabs, half spaces, a point in all of space.

Tolerances are 4 standard errors unless a table has fewer digits; draws are fixed. More particles:
SIMMPP_TEST_PARTICLES=10 takes ten times as many.
"""

from __future__ import annotations

import math
import os

import numpy as np
import pytest
from particle_cells import point, preset, slab

from simmpp.workload.particles.cells import Cells
from simmpp.workload.particles.grid import ONE, centroids, grid_of
from simmpp.workload.particles.settings import Particles
from simmpp.workload.particles.tables import LOST, Tally
from simmpp.workload.particles.tracer import tallies

MORE = int(os.environ.get("SIMMPP_TEST_PARTICLES", "1"))
BACK, THROUGH = 4, 5
"""Numbers of the sides -z and +z."""


def leaving(tally: Tally, side: int, count: int) -> tuple[float, float]:
    """Mean weight that leaves by a side, and its standard error."""
    k = len(tally.absorbed) - 7 + side
    mean = tally.absorbed[k] / ONE / count
    square = tally.absorbed_squares[k] / ONE / count
    return mean, math.sqrt((square - mean * mean) / count)


def assert_leaves(
    cells: Cells, side: int, expected: float, count: int = 50_000, digits: float = 0.0, **how: str
) -> None:
    """``digits`` is half a unit of the last digit that is published."""
    particles = Particles(count=count * MORE, **how)
    mean, error = leaving(tallies(cells, particles), side, particles.count)
    assert abs(mean - expected) < 4 * error + digits, f"{mean} +- {error}, {expected}"


def test_a_pure_absorber_lets_through_what_beer_and_lambert_say() -> None:
    assert_leaves(slab(1.0), THROUGH, math.exp(-1.0))


@pytest.mark.parametrize(
    ("depth", "through"), [(0.1, 0.9157), (0.5, 0.7040), (1, 0.5532), (2, 0.3900), (5, 0.2077)]
)
def test_isotropic_slab_without_absorption_under_lamberts_light(
    depth: float, through: float
) -> None:
    """Source: Heaslet and Warming 1965, "Radiative transport and wall temperature slip"."""
    cells = slab(depth, albedo=1.0, emits="cosine")
    assert_leaves(cells, THROUGH, through, digits=0.00005)


@pytest.mark.parametrize("capture", ["analogue", "implicit"])
@pytest.mark.parametrize(("side", "expected"), [(BACK, 0.09739), (THROUGH, 0.66096)])
def test_forward_scattering_slab(capture: str, side: int, expected: float) -> None:
    """Source: van de Hulst 1980, table 35, as MCML's authors compare with it (1995, table 1)."""
    assert_leaves(preset("slab"), side, expected, digits=0.000005, capture=capture)


def h_of(albedo: float, mu: float) -> float:
    """Chandrasekhar's H for isotropic scattering, from its integral equation."""
    x, w = np.polynomial.legendre.leggauss(200)
    nodes, weights = (x + 1) / 2, w / 2
    h, far = np.ones_like(nodes), math.sqrt(1 - albedo)
    for _ in range(1000):
        kernel = nodes / (nodes[:, None] + nodes)
        new = 1 / (far + albedo / 2 * (kernel * h * weights).sum(axis=1))
        if np.abs(new - h).max() < 1e-13:
            break
        h = (h + new) / 2
    return float(1 / (far + albedo / 2 * (nodes / (mu + nodes) * h * weights).sum()))


def test_h_is_that_of_chandrasekhars_table() -> None:
    """Source: Chandrasekhar 1950, "Radiative transfer", table XI: H(1) = 2.9078 of albedo 1."""
    assert h_of(1.0, 1.0) == pytest.approx(2.9078, abs=0.0005)


@pytest.mark.parametrize("albedo", [0.5, 0.9])
def test_half_space_sends_back_what_chandrasekhar_says(albedo: float) -> None:
    """Of 40 mean free paths less than 1e-9 comes through."""
    expected = 1 - h_of(albedo, 1.0) * math.sqrt(1 - albedo)
    assert_leaves(slab(40.0, albedo=albedo), BACK, expected)


@pytest.mark.parametrize("capture", ["analogue", "implicit"])
@pytest.mark.parametrize("name", ["slab", "shield"])
def test_nothing_is_lost(capture: str, name: str) -> None:
    """What leaves, what stays and what roulette takes is all that began: exactly."""
    particles = Particles(count=5_000, capture=capture, splitting=True)
    tally = tallies(preset(name), particles)
    assert tally.absorbed.sum() == 5_000 * ONE
    if capture == "analogue" and name == "slab":
        whole = tally.absorbed // ONE * ONE
        assert (tally.absorbed == whole).all() and tally.absorbed[-7 + LOST] == 0


def test_point_source_far_from_it_is_that_of_diffusion() -> None:
    """exp(-kappa r) / (4 pi D r) beyond 5 mean free paths, in bins of one."""
    n, albedo, count = 41, 0.99, 10_000 * MORE
    cells = point(n, albedo)
    tally = tallies(cells, Particles(count=count, capture="implicit"))
    distances = np.linalg.norm(centroids(grid_of(cells)) - n / 2, axis=1)
    diffusion = 1 / 3
    kappa = math.sqrt((1 - albedo) / diffusion)
    with np.errstate(divide="ignore"):
        flux = np.exp(-kappa * distances) / (4 * math.pi * diffusion * distances)
    obtained = tally.tracks[:-7] / ONE / count
    for near in (5, 7, 9):
        shell = (distances >= near) & (distances < near + 2)
        assert obtained[shell].sum() == pytest.approx(flux[shell].sum(), rel=0.02)


def deep(count: int, seeds: range, **how: str | bool) -> tuple[float, float]:
    """Track length in the shield's last 20 cm, and its standard error, from as many runs."""
    cells = preset("shield")
    last = (centroids(grid_of(cells)) > 80).any(axis=1)
    means = [
        tallies(cells, Particles(count=count * MORE, seed=seed, **how)).tracks[:-7][last].sum()
        / (ONE * count * MORE)
        for seed in seeds
    ]
    return float(np.mean(means)), float(np.std(means, ddof=1)) / math.sqrt(len(means))


@pytest.fixture(scope="module")
def unweighed() -> tuple[float, float]:
    return deep(20_000, range(16))


@pytest.mark.parametrize(
    ("capture", "splitting"), [("implicit", False), ("analogue", True), ("implicit", True)]
)
def test_weights_and_parts_do_not_move_the_mean(
    capture: str, splitting: bool, unweighed: tuple[float, float]
) -> None:
    mean, error = deep(2_000, range(100, 116), capture=capture, splitting=splitting)
    assert abs(mean - unweighed[0]) < 4 * math.hypot(error, unweighed[1])
    assert error < 0.1 * mean
