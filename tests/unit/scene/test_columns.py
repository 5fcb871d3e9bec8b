"""Columns say of objects what the objects say, and leave them as they are."""

import numpy as np

from simmpp.scene.columns import KINDS, columns, columns_of
from simmpp.scene.scene import Camera, Cone, Material, MeshPart, Polygon, Scene, Sphere
from simmpp.scene.tiling import faces_of
from simmpp.scene.triangles import triangles
from simmpp.workload.workload import OBJECT_KINDS

U = [(0, 0, 0), (3, 0, 0), (3, 3, 0), (2, 3, 0), (2, 1, 0), (1, 1, 0), (1, 3, 0), (0, 3, 0)]
SQUARE = np.array([(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
OBJECTS = (
    Sphere((0.0, 1.0, 2.0), 3.0, 1),
    Polygon(SQUARE),
    MeshPart(SQUARE + 2, np.array([(0, 1, 2), (0, 2, 3)], np.int32), 1),
    Cone((0.0, 0, 0), 1.0, (4.0, 5.0, 6.0), 0.5),
    Polygon(np.array(U, float), np.ones((8, 3))),
    MeshPart(SQUARE[:3], np.array([(2, 1, 0)])),
)


def test_kinds_are_those_of_workloads() -> None:
    assert KINDS == OBJECT_KINDS


def test_columns() -> None:
    found = columns(OBJECTS)
    assert [KINDS[kind] for kind in found.kinds] == [obj.kind for obj in OBJECTS]
    assert found.materials.tolist() == [1, 0, 1, 0, 0, 0]
    assert found.spheres.tolist() == [[0, 1, 2, 3]]
    assert found.cones.tolist() == [[0, 0, 0, 1, 4, 5, 6, 0.5]]
    assert found.n_vertices.tolist() == [0, 4, 4, 0, 8, 3]
    assert found.n_normals.tolist() == [0, 0, 0, 0, 8, 0]
    assert found.n_faces.tolist() == [0, 0, 2, 0, 0, 1]


def test_triangles_are_those_of_each_object() -> None:
    found = columns(OBJECTS)
    faces, owners = faces_of(found)
    expected = [triangles(obj) for obj in OBJECTS]
    np.testing.assert_array_equal(found.vertices[faces], np.concatenate(expected))
    assert owners.tolist() == np.repeat(np.arange(6), list(map(len, expected))).tolist()


def test_objects_are_left_as_they_are() -> None:
    part = MeshPart(SQUARE, np.array([(0, 1, 2)], np.int32))
    columns((Polygon(SQUARE), part))
    assert part.faces.tolist() == [[0, 1, 2]]


def test_columns_of_a_scene_are_made_once() -> None:
    camera = Camera((0.0, 0, 9), (0.0, 0, 0))
    scene = Scene("made", OBJECTS, (Material(), Material()), (), camera)
    assert columns_of(scene) is columns_of(scene)
