"""Scenes cut into patches, and what is refused."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from path_scenes import quad

import simmpp
from simmpp.common.errors import ConfigError, InputError, SceneError
from simmpp.config.config import config_from_mapping
from simmpp.scene.scene import Camera, Material, MeshPart, Polygon, Scene, SceneObject, Sphere
from simmpp.workload.radiosity.patches import patches_of
from simmpp.workload.radiosity.settings import Radiosity

LAMP = Material((0.5, 0.5, 0.5), emission=(1.0, 1.0, 1.0))
SQUARE = quad((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0))
HALF = Polygon(np.array([(0, 0, 1), (4, 0, 1), (0, 3, 1)], np.float64), None, 0)


def scene_of(*objects: SceneObject, material: Material = LAMP) -> Scene:
    return Scene("patches", objects, (material,), (), Camera((9, 9, 9), (0, 0, 0)))


def corners(scene: Scene, area: Any) -> list[list[tuple[float, ...]]]:
    patches = patches_of(scene, Radiosity(patches=area))
    assert patches.scene.objects[0].material == 0
    return [[tuple(v) for v in obj.vertices.tolist()] for obj in patches.scene.objects]  # type: ignore[union-attr]


def test_quadrilaterals_are_halved_across_their_longer_sides() -> None:
    long = quad((0, 0, 0), (4, 0, 0), (4, 1, 0), (0, 1, 0))
    halves = corners(scene_of(long), 3.0)
    assert [sorted({point[0] for point in half}) for half in halves] == [[0, 2], [2, 4]]
    quarters = corners(scene_of(SQUARE), 1.0)
    assert [np.mean(quarter, axis=0).tolist() for quarter in quarters] == [
        [0.5, 0.5, 0], [0.5, 1.5, 0], [1.5, 0.5, 0], [1.5, 1.5, 0]
    ]  # fmt: skip


def test_triangles_are_halved_from_the_middle_of_their_longest_side() -> None:
    halves = corners(scene_of(HALF), 3.0)
    assert [sorted(half) for half in halves] == [
        [(0, 0, 1), (2, 1.5, 1), (4, 0, 1)], [(0, 0, 1), (0, 3, 1), (2, 1.5, 1)]
    ]  # fmt: skip


def test_halves_keep_their_front_and_all_of_the_area() -> None:
    scene = scene_of(SQUARE, HALF)
    patches = patches_of(scene, Radiosity(patches="1%"))
    assert patches.areas.sum() == pytest.approx(10, rel=1e-12)
    assert patches.areas.max() <= 0.1
    assert np.bincount(patches.parts).tolist() == [64, 64]
    for obj in patches.scene.objects:
        a, b, c = obj.vertices[:3]  # type: ignore[union-attr]
        assert np.cross(b - a, c - b)[2] > 0


def test_triangles_of_a_mesh_are_joined_where_they_make_a_quadrilateral() -> None:
    points = np.array(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (1, 1, 1), (0, 1, 1)], np.float64
    )
    faces = [(0, 1, 2), (0, 2, 3), (3, 2, 4), (3, 4, 5), (0, 1, 2)]
    mesh = MeshPart(points, np.array(faces, np.int32), 0)
    found = corners(scene_of(mesh), 10.0)
    assert [len(patch) for patch in found] == [4, 4, 3]
    assert sorted(found[0]) == sorted(map(tuple, points[:4].tolist()))
    bent = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0.001)], np.float64)
    mesh = MeshPart(bent, np.array(faces[:2], np.int32), 0)
    assert [len(patch) for patch in corners(scene_of(mesh), 10.0)] == [3, 3]


def test_concave_polygons_become_patches_that_are_convex() -> None:
    arrow = quad((0, 0, 0), (2, 2, 0), (0, 1, 0), (-2, 2, 0))
    assert [len(patch) for patch in corners(scene_of(arrow), 10.0)] == [3, 3]


WRONG_SCENES = {
    "object 1 has a patch of no area": (
        scene_of(SQUARE, quad((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0))), {}
    ),
    "object 1 is curved: expected polygons": (scene_of(SQUARE, Sphere((0, 0, 0), 1)), {}),
    "nothing shines: expected a material with Ke": (scene_of(SQUARE, material=Material()), {}),
    "nothing shines": (scene_of(), {}),
    "material 0 reflects 1.5 of what reaches it: expected at most 1": (
        scene_of(SQUARE, material=Material((0.75, 0.5, 0.5), kd=2.0, emission=(1, 1, 1))), {}
    ),
    "there would be more than 16777216 patches": (scene_of(SQUARE), {"patches": 1e-9}),
}  # fmt: skip


@pytest.mark.parametrize("problem", WRONG_SCENES)
def test_nonsense_is_refused(problem: str) -> None:
    scene, settings = WRONG_SCENES[problem]
    with pytest.raises(InputError) as caught:
        patches_of(scene, Radiosity(**settings))
    assert problem in str(caught.value)
    assert "\n" not in str(caught.value)


def test_coordinates_that_are_not_finite_are_refused() -> None:
    broken = quad((0, 0, 0), (1, 0, 0), (1, np.nan, 0), (0, 1, 0))
    with pytest.raises(SceneError, match=r"object 1 has a coordinate that is not finite"):
        patches_of(scene_of(SQUARE, broken), Radiosity())


WRONG_SETTINGS = {
    "residual: value 0: expected a share above 0%": {"method": "shooting", "residual": 0},
    "residual: value -0.1: expected a share above 0%": {"method": "shooting", "residual": -0.1},
    "residual: value '100%': expected a share above 0%": {"method": "shooting", "residual": "100%"},
    "residual goes with method: shooting": {"residual": "2%"},
    "patches: value 0: expected a share of all surface": {"patches": 0},
    "patches: value '0%': expected a share of all surface": {"patches": "0%"},
    "patches: value 'small': expected a share of all surface": {"patches": "small"},
    "rays: value 0: expected": {"rays": 0},
    "method: value 'hierarchical': expected": {"method": "hierarchical"},
}


@pytest.mark.parametrize("problem", WRONG_SETTINGS)
def test_settings_that_make_no_sense_are_refused(problem: str) -> None:
    with pytest.raises(ConfigError) as caught:
        config_from_mapping({"scene": "mountain:3", "radiosity": WRONG_SETTINGS[problem]})
    assert str(caught.value).startswith(("radiosity." + problem, "radiosity: " + problem))


def test_there_is_a_picture_or_radiosity() -> None:
    with pytest.raises(
        ConfigError, match=r"expected one of picture, radiosity.*got picture and ra"
    ):
        config_from_mapping({"scene": "mountain:3", "picture": {}, "radiosity": {}})
    with pytest.raises(ConfigError, match=r"radiosity goes with a scene that is traced"):
        config_from_mapping({"scene": {"workload": "w.parquet"}, "radiosity": {}})


def test_areas_may_be_shares_or_numbers() -> None:
    assert Radiosity(patches="1%").patches == Fraction(1, 100)
    assert Radiosity(patches=2).patches == 2.0
    assert simmpp.load_scene("mountain:3").objects
