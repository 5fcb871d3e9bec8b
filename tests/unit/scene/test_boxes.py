"""Boxes hold their object and touch it on all six sides."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from simmpp.scene.boxes import boxes, scene_box
from simmpp.scene.scene import Cone, MeshPart, Polygon, Sphere

COORDINATE = st.floats(-10, 10)
POINT = st.tuples(COORDINATE, COORDINATE, COORDINATE)


def box(item):
    return boxes([item])[0]


def test_sphere() -> None:
    np.testing.assert_array_equal(box(Sphere((1, 2, 3), 0.5)), [(0.5, 1.5, 2.5), (1.5, 2.5, 3.5)])


def test_a_cylinder_along_an_axis_is_exact() -> None:
    cylinder = Cone((0, 0, 1), 0.25, (0, 0, 4), 0.25)
    np.testing.assert_array_equal(box(cylinder), [(-0.25, -0.25, 1), (0.25, 0.25, 4)])


@given(POINT, POINT, st.floats(0, 5), st.floats(0, 5))
def test_cone_boxes_are_those_of_its_rims(
    base: tuple[float, float, float],
    apex: tuple[float, float, float],
    base_radius: float,
    apex_radius: float,
) -> None:
    assume(math.dist(base, apex) > 1e-3)
    axis = np.subtract(apex, base) / math.dist(base, apex)
    side = np.linalg.svd(axis[None])[2][1:]
    angles = np.linspace(0, 2 * math.pi, 2001)
    circle = np.outer(np.cos(angles), side[0]) + np.outer(np.sin(angles), side[1])
    rims = np.concatenate([base + base_radius * circle, apex + apex_radius * circle])
    low, high = box(Cone(base, base_radius, apex, apex_radius))
    np.testing.assert_allclose(low, rims.min(axis=0), atol=1e-4)
    np.testing.assert_allclose(high, rims.max(axis=0), atol=1e-4)
    assert (rims >= low - 1e-9).all() and (rims <= high + 1e-9).all()


def test_many_at_once_are_the_same_as_one_by_one() -> None:
    spare = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [99, 99, 99]], dtype=np.float64)
    items = [
        Sphere((0, 0, 0), 1),
        Polygon(np.eye(3)),
        Cone((0, 0, 0), 1, (1, 1, 1), 0),
        MeshPart(spare, np.array([[0, 1, 2]], dtype=np.int32)),
        Sphere((5, 5, 5), 2),
    ]
    many = boxes(items)
    for item, bounds in zip(items, many, strict=True):
        np.testing.assert_array_equal(bounds, box(item))
    np.testing.assert_array_equal(many[3], [(0, 0, 0), (1, 1, 0)])
    np.testing.assert_array_equal(scene_box(items), [(-1, -1, -1), (7, 7, 7)])
    assert boxes([]).shape == (0, 2, 3)


def test_boxes_of_flat_objects_have_no_thickness() -> None:
    flat = Polygon(np.array([[0, 0, 2], [1, 0, 2], [0, 1, 2]], dtype=np.float64))
    assert box(flat)[0, 2] == box(flat)[1, 2] == 2
    disc = Cone((0, 0, 0), 1, (0, 3, 0), 0)
    assert box(disc)[0, 1] == pytest.approx(0, abs=0)
