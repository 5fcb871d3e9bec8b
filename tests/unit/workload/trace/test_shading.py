"""Pictures of scenes whose colours can be worked out by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from PIL import Image

from simmpp.common.errors import WorkloadError
from simmpp.scene.scene import Camera, Light, Material, Polygon, Scene, Sphere
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.shading import AMBIENT, render, save_png
from simmpp.workload.trace.tracer import trace

WALL = Polygon(np.array([[-9.0, 0, -9], [9, 0, -9], [9, 0, 9], [-9, 0, 9]]))
"""In the plane y = 0, its normal towards -y, where the camera is."""
RED = Material(colour=(1.0, 0.5, 0.0), kd=0.8)
CAMERA = Camera(eye=(0.0, -5.0, 0.0), at=(0.0, 0.0, 0.0), angle_degrees=1.0)
TINY = Picture(resolution=2)


def picture_of(scene: Scene, picture: Picture = TINY) -> np.ndarray:
    return render(scene, picture, trace(scene, picture))


SUN = Light((0.0, -1e6, 0.0))


def made(*objects, materials=(RED,), lights=(SUN,), background=(0.2, 0.4, 0.6)):
    return Scene("made", objects, materials, lights, CAMERA, background)


def quantised(*colour: float) -> list[int]:
    return np.rint(255 * np.clip(colour, 0, 1)).astype(int).tolist()


def test_nothing_is_background() -> None:
    assert picture_of(made()).tolist() == [[quantised(0.2, 0.4, 0.6)] * 2] * 2


def test_a_wall_lit_from_the_front() -> None:
    lit = (AMBIENT + 0.5) * 0.8  # one light: sqrt(1) / 2
    assert picture_of(made(WALL))[0, 0].tolist() == quantised(lit, lit / 2, 0.0)


def test_lights_share_their_intensity() -> None:
    lights = (Light((0.0, -1e6, 0.0)), Light((0.0, -1e6, 0.0), (0.0, 1.0, 0.0)))
    each = np.sqrt(2) / 4
    expected = 0.8 * (AMBIENT + each), 0.4 * (AMBIENT + 2 * each), 0.0
    assert picture_of(made(WALL, lights=lights))[0, 0].tolist() == quantised(*expected)


def test_a_wall_in_shadow_and_one_lit_from_behind_are_ambient() -> None:
    ambient = quantised(0.8 * AMBIENT, 0.4 * AMBIENT, 0.0)
    blocker = Sphere((0.0, -100.0, 0.0), 20.0)
    assert picture_of(made(WALL, blocker))[0, 0].tolist() == ambient
    assert picture_of(made(WALL, lights=(Light((0.0, 5.0, 0.0)),)))[0, 0].tolist() == ambient
    bright = picture_of(made(WALL, blocker), dataclasses.replace(TINY, shadows=False))
    assert bright[0, 0].tolist() == picture_of(made(WALL))[0, 0].tolist()


def test_a_mirror_shows_what_is_before_it() -> None:
    mirror = Material(colour=(0.0, 0.0, 0.0), ks=0.5, shine=1e5)
    seen = picture_of(made(WALL, materials=(mirror,), lights=()))
    assert seen[0, 0].tolist() == quantised(0.1, 0.2, 0.3)


def test_glass_shows_what_is_behind_it() -> None:
    glass = Material(colour=(0.0, 0.0, 0.0), transmittance=0.5, ior=1.0)
    behind = Polygon(WALL.vertices + np.array([0.0, 2.0, 0.0]), material=1)
    dim = Material(colour=(1.0, 1.0, 1.0), kd=1.0)
    seen = picture_of(made(WALL, behind, materials=(glass, dim), lights=()))
    assert seen[0, 0].tolist() == quantised(*[0.5 * AMBIENT] * 3)


def test_the_picture_is_the_right_way_up_and_round() -> None:
    """x to the right, z up, seen along +y."""
    ball = Sphere((0.03, 0.0, 0.03), 0.02)
    seen = picture_of(made(ball), Picture(resolution=32))
    rows, columns = np.nonzero((seen != quantised(0.2, 0.4, 0.6)).any(axis=2))
    assert rows.mean() < 12 and columns.mean() > 20


def test_corners_are_averaged() -> None:
    half = Polygon(np.array([[0.0, 0, -9], [9, 0, -9], [9, 0, 9], [0, 0, 9]]))
    picture = dataclasses.replace(TINY, samples="corners")
    left, right = (picture_of(made(half, lights=()), picture)[0, c].tolist() for c in (0, 1))
    wall = np.array([0.8, 0.4, 0.0]) * AMBIENT
    assert right == quantised(*wall)
    assert left == quantised(*((wall + np.array([0.2, 0.4, 0.6])) / 2))


def test_a_workload_of_another_scene_is_refused() -> None:
    with pytest.raises(WorkloadError, match="another scene"):
        render(made(WALL), TINY, trace(made(), TINY))


def test_a_png_holds_the_picture(tmp_path) -> None:
    image = picture_of(load_scene("mountain:1"), Picture(resolution=16))
    save_png(image, tmp_path / "picture")
    with Image.open(tmp_path / "picture") as file:
        assert file.format == "PNG" and np.array_equal(np.array(file), image)
