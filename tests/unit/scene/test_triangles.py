"""Triangles of polygons and mesh parts: same area, same side, no overlap."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.scene.nff import read_nff
from simmpp.scene.scene import Cone, Floats, MeshPart, Polygon, Sphere
from simmpp.scene.spd.generators import nff
from simmpp.scene.triangles import triangles

TILT = np.linalg.qr(np.array([[1.0, 2, 3], [0, 1, 4], [5, 6, 0]]))[0]
TILT *= np.sign(np.linalg.det(TILT))


def area_vector(vertices: Floats) -> Floats:
    return np.cross(vertices, np.roll(vertices, -1, axis=0)).sum(axis=0) / 2


def triangle_areas(corners: Floats) -> Floats:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2


def star(radii: list[float]) -> Floats:
    """A polygon seen whole from the origin, mostly concave, in a tilted plane."""
    angles = np.arange(len(radii)) * (2 * math.pi / len(radii))
    flat = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    return (flat * np.array(radii)[:, None] + (0.3, 0.2, 1.0)) @ TILT.T


@given(st.lists(st.floats(0.1, 10), min_size=4, max_size=40))
def test_triangles_tile_a_polygon(radii: list[float]) -> None:
    vertices = star(radii)
    corners = triangles(Polygon(vertices))
    normal = TILT[:, 2]
    areas = triangle_areas(corners) @ normal
    scale = max(radii) ** 2
    assert (areas >= -1e-12 * scale).all(), "a triangle faces backwards"
    assert areas.sum() == pytest.approx(area_vector(vertices) @ normal, abs=1e-11 * scale)


@pytest.mark.parametrize("turn", [1, -1])
def test_a_concave_polygon_is_not_a_fan(turn: int) -> None:
    """From its first vertex an L-shape's fan would leave it."""
    ell = [(2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0), (0, 0, 0)]
    vertices = np.array(ell[::turn], dtype=np.float64)
    corners = triangles(Polygon(vertices))
    assert len(corners) == 4
    areas = triangle_areas(corners)[:, 2] * turn
    assert areas.min() > 0 and areas.sum() == pytest.approx(3)
    inside = corners.mean(axis=1)
    assert not ((inside[:, 0] > 1) & (inside[:, 1] > 1)).any()


def test_gear_faces_are_cut_without_loss() -> None:
    scene = read_nff(nff("gears", 1), name="", where="")
    faces = [p for p in scene.objects if isinstance(p, Polygon) and len(p.vertices) == 144]
    for face, side in zip(faces, (1, -1), strict=True):
        corners = triangles(face)
        assert len(corners) == 142
        areas = triangle_areas(corners)[:, 2] * side
        assert areas.min() > 0
        assert areas.sum() == pytest.approx(area_vector(face.vertices)[2] * side, rel=1e-12)


def test_convex_polygons_are_fans() -> None:
    quad = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=np.float64)
    expected = [quad[[0, 1, 2]], quad[[0, 2, 3]]]
    np.testing.assert_array_equal(triangles(Polygon(quad)), expected)
    np.testing.assert_array_equal(triangles(Polygon(quad[:3])), [quad[:3]])


@pytest.mark.parametrize(
    "vertices",
    [
        np.zeros((3, 3)),
        np.zeros((7, 3)),
        np.outer(np.arange(5.0), (1, 2, 3)),
        np.outer([0.0, 3, 1, 2, -1, 5], (1, 1, 0)),
    ],
    ids=["point", "points", "line", "folded line"],
)
def test_polygons_without_area_still_have_triangles(vertices: Floats) -> None:
    corners = triangles(Polygon(vertices))
    assert len(corners) >= 1
    assert np.abs(triangle_areas(corners)).max() == 0


def test_mesh_parts_by_faces_and_none_for_curves() -> None:
    vertices = np.arange(12, dtype=np.float64).reshape(4, 3)
    part = MeshPart(vertices, np.array([[0, 1, 2], [3, 2, 0]], dtype=np.int32))
    np.testing.assert_array_equal(triangles(part)[1], vertices[[3, 2, 0]])
    for curved in (Sphere((0, 0, 0), 1), Cone((0, 0, 0), 1, (0, 0, 1), 0)):
        assert triangles(curved).shape == (0, 3, 3)
