"""Primary rays of pictures of any shape."""

from __future__ import annotations

import math

import numpy as np
import pytest

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.scene.nff import read_nff
from simmpp.scene.scene import Camera, Scene
from simmpp.workload.digest import digest_of
from simmpp.workload.picture import Picture
from simmpp.workload.trace.camera import primary_rays
from simmpp.workload.trace.frame import Frame
from simmpp.workload.trace.shading import render
from simmpp.workload.trace.tracer import trace

FRAME = Frame(np.zeros(3), 1.0)
CAMERA = Camera((0, 0, 0), (0, 0, -1), (0, 1, 0), 60.0)


def scene(resolution: str) -> Scene:
    text = f"v from 0 0 9 at 0 0 0 up 0 1 0 angle 40 hither 1 {resolution} l 1 1 9 s 0 0 0 1\n"
    return read_nff(text, name="ball", where="ball.nff")


def slopes(picture: Picture) -> np.ndarray:
    """Right and upwards of each ray, per unit ahead: (rows, columns, 2)."""
    _, rays = primary_rays(CAMERA, picture, FRAME)
    return (rays[:, :2] / -rays[:, 2:]).reshape(*picture.shape, 2)


@pytest.mark.parametrize("sides", [(8, 3), (3, 8), (1, 5), (4, 4)])
def test_the_angle_is_that_of_the_height_and_pixels_are_squares(sides: tuple[int, int]) -> None:
    columns, rows = sides
    reach = math.tan(math.radians(30))
    corners = slopes(Picture(resolution=sides, samples="corners"))
    assert corners.shape == (rows + 1, columns + 1, 2)
    assert corners[0, 0] == pytest.approx([-reach * columns / rows, reach], rel=1e-11)
    assert corners[-1, -1] == pytest.approx([reach * columns / rows, -reach], rel=1e-11)
    centres = slopes(Picture(resolution=sides))
    between = (corners[:-1, :-1] + corners[1:, 1:]) / 2
    assert centres == pytest.approx(between, abs=1e-12)


def test_a_square_is_a_square_however_it_is_said() -> None:
    ball = scene("resolution 7 5")
    assert Picture(resolution=(9, 9)).shape == Picture(resolution=9).shape
    assert digest_of(ball, Picture(resolution=(9, 9))) == digest_of(ball, Picture(resolution=9))
    assert digest_of(ball, Picture(resolution=(9, 8))) != digest_of(
        ball, Picture(resolution=(8, 9))
    )


def test_the_resolution_of_the_scene_itself() -> None:
    ball, own = scene("resolution 7 5"), Picture(resolution="own")
    workload = trace(ball, own)
    assert workload.picture == (5, 7)
    assert workload.digest == digest_of(ball, Picture(resolution=(7, 5)))
    assert render(ball, own, workload).shape == (5, 7, 3)
    assert own.of(scene("")).shape == (512, 512)
    with pytest.raises(
        ConfigError, match=r"ball: resolution: value .*: expected an integer from 1"
    ):
        own.of(scene("resolution 20000 5"))


@pytest.mark.parametrize(
    "wrong", [0, 16385, (4,), (4, 0), (4, 4, 4), "auto", True, 4.5, None, (1, "2")]
)
def test_wrong_resolutions(wrong: object) -> None:
    with pytest.raises(
        ConfigError, match=r"resolution: value .*: expected an integer from 1 to 16384, \["
    ):
        simmpp.Picture(resolution=wrong)  # type: ignore[arg-type]


def test_a_wide_picture_shows_more_at_the_sides_of_the_same() -> None:
    ball = scene("")
    square = render(ball, small := Picture(resolution=20), trace(ball, small))
    wide = render(ball, large := Picture(resolution=(40, 20)), trace(ball, large))
    assert wide.shape == (20, 40, 3) and (wide[:, 10:30] == square).all() and not wide[:, :10].any()
