"""Proxies lie outside the surface they stand for."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from simmpp.scene.proxies import proxy_triangles
from simmpp.scene.scene import Cone, Floats, Polygon, Sphere

COORDINATE = st.floats(-10, 10)
POINT = st.tuples(COORDINATE, COORDINATE, COORDINATE)


def planes(corners: Floats) -> tuple[Floats, Floats]:
    """Unit normals and a point of each triangle that has an area."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    solid = lengths > 1e-12 * lengths.max()
    return normals[solid] / lengths[solid, None], corners[solid, 0]


def test_sphere_proxies_are_closed_and_outside() -> None:
    corners = proxy_triangles(Sphere((1, 2, 3), 0.5))
    assert corners.shape == (80, 3, 3)
    normals, points = planes(corners)
    distances = (normals * (points - (1, 2, 3))).sum(axis=1)
    assert distances.min() >= 0.5
    assert np.linalg.norm(corners - (1, 2, 3), axis=2).max() < 0.5 * 1.1
    edges = {
        (tuple(a.round(9)), tuple(b.round(9)))
        for triangle in corners
        for a, b in zip(triangle, np.roll(triangle, -1, axis=0), strict=True)
    }
    assert len(edges) == 240 and all((b, a) in edges for a, b in edges)


@given(POINT, POINT, st.floats(0, 5), st.floats(0, 5))
def test_cone_proxies_are_outside(
    base: tuple[float, float, float],
    apex: tuple[float, float, float],
    base_radius: float,
    apex_radius: float,
) -> None:
    assume(math.dist(base, apex) > 1e-2 and max(base_radius, apex_radius) > 1e-2)
    corners = proxy_triangles(Cone(base, base_radius, apex, apex_radius))
    assert corners.shape == (24, 3, 3) and np.isfinite(corners).all()
    axis = np.subtract(apex, base) / math.dist(base, apex)
    side = np.linalg.svd(axis[None])[2][1:]
    angles = np.linspace(0, 2 * math.pi, 181)
    circle = np.outer(np.cos(angles), side[0]) + np.outer(np.sin(angles), side[1])
    rims = np.concatenate([base + base_radius * circle, apex + apex_radius * circle])
    normals, points = planes(corners)
    heights = rims @ normals.T - (points * normals).sum(axis=1)
    centre = (np.add(base, apex) / 2) @ normals.T - (points * normals).sum(axis=1)
    assert (heights * np.sign(centre) >= -1e-9).all()
    along = (corners.reshape(-1, 3) - base) @ axis
    assert along.min() < 0 and along.max() > math.dist(base, apex)


def test_flat_objects_are_their_own() -> None:
    np.testing.assert_array_equal(proxy_triangles(Polygon(np.eye(3))), [np.eye(3)])


@pytest.mark.parametrize("radii", [(1e-9, 1e-9), (1e-9, 0), (0, 1)])
def test_thin_and_pointed_cones(radii: tuple[float, float]) -> None:
    corners = proxy_triangles(Cone((0, 0, 0), radii[0], (0, 0, 1), radii[1]))
    assert np.isfinite(corners).all()
    reach = np.linalg.norm(corners[..., :2], axis=2)
    assert reach.max() < 1.1 * max(radii)
    if 0 in radii:  # beyond the tip there is nothing to hold: the proxy ends in a point
        end = corners[..., 2] > 1 if radii[1] == 0 else corners[..., 2] < 0
        assert end.any() and reach[end].max() < 1e-15
