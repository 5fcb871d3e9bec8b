"""Path tracing against closed forms: a room that shines everywhere, a lamp over a floor.

Statistical tolerances are 4 standard errors of the mean of independent paths; draws are fixed.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from path_scenes import LAMP, furnace, irradiance, lamp_over_floor, room

from simmpp.scene.scene import Light, Scene
from simmpp.workload.picture import Picture
from simmpp.workload.trace.path.radiance import light_of_roots
from simmpp.workload.trace.replay import traced
from simmpp.workload.trace.tracer import trace

NEVER = 1001
"""Depth from which the roulette ends paths, where it shall not."""


def light_of(scene: Scene, **settings: object) -> NDArray[np.float64]:
    """What each path brings home: (n, 3)."""
    picture = Picture(render="path", **settings)
    workload = trace(scene, picture)
    return light_of_roots(traced(scene, picture, workload), workload.hits.copy())


def assert_mean(paths: NDArray[np.float64], expected: NDArray[np.float64] | float) -> None:
    error = paths.std(axis=0, ddof=1) / len(paths) ** 0.5
    assert (np.abs(paths.mean(axis=0) - expected) < 4 * error).all()


def assert_same_mean(one: NDArray[np.float64], other: NDArray[np.float64]) -> None:
    error = np.sqrt(one.var(axis=0) / len(one) + other.var(axis=0) / len(other))
    assert (np.abs(one.mean(axis=0) - other.mean(axis=0)) < 4 * error).all()


@pytest.mark.parametrize("glossy", [False, True])
@pytest.mark.parametrize("depth", [1, 2, 9])
def test_white_furnace(glossy: bool, depth: int) -> None:
    """Each hit adds what shines there: the sum of rho^k, whatever way a path goes."""
    rho = 0.8
    paths = light_of(
        furnace(rho, glossy=glossy), resolution=16, samples=2, depth=depth, roulette=NEVER,
        shadows=False,
    )  # fmt: skip
    expected = (1 - rho**depth) / (1 - rho)
    np.testing.assert_allclose(paths, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("glossy", [False, True])
@pytest.mark.parametrize("shadows", [False, True])
def test_white_furnace_with_roulette_and_light_samples(glossy: bool, shadows: bool) -> None:
    rho, depth = 0.7, 8
    paths = light_of(
        furnace(rho, glossy=glossy), resolution=32, samples=16, depth=depth, roulette=2,
        shadows=shadows,
    )  # fmt: skip
    assert_mean(paths, (1 - rho**depth) / (1 - rho))


@pytest.mark.parametrize("shadows", [False, True])
def test_lamp_over_a_floor(shadows: bool) -> None:
    """The lamp's light is found by light samples, or by rays that hit it by chance."""
    paths = light_of(lamp_over_floor(), resolution=64, samples=8, depth=2, shadows=shadows)
    sent = np.array([0.8, 0.5, 0.2]) * np.array([2.0, 1.0, 0.5])
    assert_mean(paths, sent * irradiance(LAMP) / np.pi)


def test_a_point_is_as_bright_as_in_whitted_pictures() -> None:
    scene = lamp_over_floor()
    lit = Scene("point", scene.objects[:1], scene.materials, (Light((0, 3, 4)),), scene.camera)
    paths = light_of(lit, resolution=4, samples=2)
    brightness = 0.5 * 0.8  # sqrt(L) / (2 L) of one light, and the cosine
    np.testing.assert_allclose(paths, brightness * np.array([[0.8, 0.5, 0.2]] * 32), rtol=1e-5)


def test_roulette_is_unbiased() -> None:
    scene = room((Light((5, 5, 8), (0.2, 0.2, 0.6)),))
    settings = {"resolution": 48, "samples": 16, "depth": 10}
    one = light_of(scene, **settings, roulette=1, seed=1)
    other = light_of(scene, **settings, roulette=NEVER, seed=2)
    assert_same_mean(one, other)


def test_light_is_counted_at_hits_or_by_samples() -> None:
    """Of a lamp that light samples find, and of one that rays have to hit: the same light."""
    settings = {"resolution": 48, "samples": 16, "depth": 4, "roulette": NEVER}
    one = light_of(room(), **settings, seed=3)
    other = light_of(room(), **settings, seed=4, shadows=False)
    assert_same_mean(one, other)
