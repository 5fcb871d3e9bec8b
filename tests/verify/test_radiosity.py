"""Radiosity against closed forms: form factors, a white furnace, energy that is never lost.

Tolerances of form factors are 4 standard errors of a count of n rays, as if each were drawn alone.
The Cornell box is compared with Mitsuba's paths by experiments/rays/patches.py: its table is read.
"""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from path_scenes import quad, walls
from scipy.sparse import csr_array

from simmpp.common.files import read_csv
from simmpp.scene.scene import Camera, Material, Polygon, Scene, SceneObject
from simmpp.workload.radiosity.gathering import Gathering, brightness, form_factors
from simmpp.workload.radiosity.room import Room, room_of
from simmpp.workload.radiosity.settings import Radiosity
from simmpp.workload.radiosity.shooting import Shooting
from simmpp.workload.radiosity.tracing import again, trace_patches

Floats = NDArray[np.float64]
SHINES = Material((0.5, 0.5, 0.5), emission=(1.0, 1.0, 1.0))
CAMERA = Camera((9.0, 9.0, 9.0), (0.0, 0.0, 0.0))
WHOLE = 1e9
"""Larger than any patch: nothing is cut."""


def scene_of(*objects: SceneObject, materials: tuple[Material, ...] = (SHINES,)) -> Scene:
    return Scene("patches", objects, materials, (), CAMERA)


def solved(scene: Scene, settings: Radiosity) -> tuple[Room, Gathering | Shooting]:
    room = room_of(scene, settings)
    return room, again(room, trace_patches(room, threads=1))[0]


def factors_of(scene: Scene, settings: Radiosity) -> tuple[Room, Floats, NDArray[np.int64]]:
    """Form factors of fronts (N, N), and how many rays each has sent."""
    room, task = solved(scene, settings)
    assert isinstance(task, Gathering)
    sent, places = task.pairs
    factors = form_factors(room.n_sides, sent, places).toarray()
    return room, factors[0::2, 0::2], np.bincount(sent)[0::2]


def inward(low: tuple[float, float, float], high: tuple[float, float, float]) -> list[SceneObject]:
    """Six walls whose fronts are inside."""
    centre = (np.array(low) + np.array(high)) / 2
    found: list[SceneObject] = []
    for wall in walls(low, high, (0,) * 6):
        corners = wall.vertices  # type: ignore[union-attr]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[1])
        turned = corners if normal @ (centre - corners[0]) > 0 else corners[::-1].copy()
        found.append(Polygon(turned, None, wall.material))
    return found


def sphere(subdivisions: int) -> list[SceneObject]:
    """Triangles of a ball of radius 1, an octahedron refined."""
    axes = np.eye(3)
    faces = [
        np.array([x * axes[0], y * axes[1], z * axes[2]])[:: int(x * y * z)]
        for x, y, z in itertools.product((1, -1), repeat=3)
    ]
    for _ in range(subdivisions):
        finer = []
        for a, b, c in faces:
            ab, bc, ca = ((p + q) / np.linalg.norm(p + q) for p, q in ((a, b), (b, c), (c, a)))
            finer += [np.array(f) for f in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        faces = finer
    return [Polygon(face, None, 0) for face in faces]


def disc(radius: float, z: float, n: int = 64) -> Polygon:
    """Faces up."""
    turns = 2 * np.pi * np.arange(n) / n
    points = [radius * np.cos(turns), radius * np.sin(turns), np.full(n, z)]
    return Polygon(np.stack(points, axis=1), None, 0)


def parallel(side: float, distance: float) -> float:
    x = side / distance
    inner = math.log((1 + x * x) / math.sqrt(1 + 2 * x * x))
    inner += 2 * x * math.sqrt(1 + x * x) * math.atan(x / math.sqrt(1 + x * x)) - 2 * x * math.atan(
        x
    )
    return 2 / (math.pi * x * x) * inner


FLOOR = quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
CEILING = quad((0, 0, 1), (0, 1, 1), (1, 1, 1), (1, 0, 1))
WALL = quad((0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1))


@pytest.mark.parametrize(
    ("other", "expected"),
    [(CEILING, 0.199825), (WALL, 0.200044)],
    ids=["parallel", "perpendicular"],
)
def test_unit_squares_see_each_other_as_published(other: Polygon, expected: float) -> None:
    if other is CEILING:
        assert parallel(1, 1) == pytest.approx(expected, abs=5e-7)
        assert parallel(1, 1) + 4 * 0.200044 == pytest.approx(1, abs=2e-6)  # a cube is closed
    n = 65536
    _, factors, _ = factors_of(scene_of(FLOOR, other), Radiosity(rays=n, patches=WHOLE))
    error = math.sqrt(expected * (1 - expected) / n)
    assert factors.diagonal().tolist() == [0, 0]
    assert abs(factors[0, 1] - expected) < 4 * error
    assert abs(factors[1, 0] - expected) < 4 * error


@pytest.mark.parametrize(("radius", "height"), [(1.0, 2.0), (3.0, 2.0), (5000.0, 2.5)])
def test_a_ball_sees_a_disc_below_it(radius: float, height: float) -> None:
    ball = sphere(3)  # 512 triangles: chords leave out 0.3 % of the directions at most
    scene = scene_of(*ball, disc(radius, -height))
    room, factors, sent = factors_of(scene, Radiosity(rays=64, patches=WHOLE))
    mine, n = room.patches.areas[: len(ball)], int(sent[: len(ball)].sum())
    seen = factors[: len(ball), len(ball) :].sum(axis=1)
    obtained = float(mine @ seen / mine.sum())
    expected = (1 - 1 / math.sqrt(1 + (radius / height) ** 2)) / 2
    assert abs(obtained - expected) < 4 * math.sqrt(expected * (1 - expected) / n) + 0.003


BOX = scene_of(*inward((0, 0, 0), (3, 2, 1)))


def test_no_ray_of_a_closed_room_is_lost() -> None:
    room, task = solved(BOX, Radiosity(rays=64, patches="1%"))
    assert isinstance(task, Gathering)
    sent, places = task.pairs
    inside = sent % 2 == 0
    assert room.n_sides > 200
    assert (places[inside] >= 0).all()
    assert (places[inside] % 2 == 0).all()
    assert (places[~inside] == -1).all()


def test_patches_see_each_other_alike() -> None:
    room, seen, sent = factors_of(BOX, Radiosity(rays=512, patches="4%"))
    areas = room.patches.areas
    one, other = areas[:, None] * seen, (areas[:, None] * seen).T
    # Both estimate A_i F_ij: their common value by all rays gives both errors.
    both = (one * sent[:, None] + other * sent) / (sent[:, None] + sent)
    mine = both * (areas[:, None] - both) / sent[:, None]
    error = np.sqrt(np.maximum(mine + mine.T, 0))
    assert (np.abs(one - other) <= 4 * error).all()


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9])
def test_a_white_furnace_is_as_bright_as_it_can_be(rho: float) -> None:
    walls = Material((rho, rho, rho), emission=(1.0, 2.0, 0.5))
    scene = scene_of(*inward((0, 0, 0), (3, 2, 1)), materials=(walls,))
    light = solved(scene, Radiosity(rays=32, patches="1%"))[1].brightness
    assert np.allclose(light[0::2], np.array(walls.emission) / (1 - rho), rtol=1e-10, atol=0)
    assert np.allclose(light[1::2], walls.emission, rtol=1e-15, atol=0)


def lit(open_front: bool) -> Scene:
    """A room of grey, red and blue walls, its ceiling a lamp; its front may be missing."""
    grey, red = Material((0.6, 0.6, 0.6)), Material((0.7, 0.2, 0.1))
    lamp = Material((0.3, 0.3, 0.3), emission=(3.0, 2.0, 1.0))
    faces = inward((0, 0, 0), (3, 2, 1))
    chosen = [0, 0, 1, 0, 0, 2]
    objects = [Polygon(f.vertices, None, m) for f, m in zip(faces, chosen, strict=True)]  # type: ignore[union-attr]
    return scene_of(*objects[1:] if open_front else objects, materials=(grey, red, lamp))


@pytest.mark.parametrize("open_front", [False, True])
def test_no_unit_of_power_is_lost(open_front: bool) -> None:
    settings = Radiosity(method="shooting", rays=101, patches="4%", residual="2%")
    room, task = solved(lit(open_front), settings)
    assert isinstance(task, Shooting)
    accounted = task.absorbed + task.escaped + task.unshot.sum(axis=0)
    assert accounted.tolist() == task.emitted.sum(axis=0).tolist()
    assert 2**50 <= int(task.emitted.sum()) < 2**51
    # The lamp shines out of the room, too: half of its power, if that is closed.
    outside = task.emitted[1::2].sum(axis=0)
    assert (task.escaped > outside).all() if open_front else (task.escaped == outside).all()
    assert task.residual <= room.settings.residual


def test_both_methods_find_the_same_light() -> None:
    one = solved(lit(True), Radiosity(rays=2048, patches="4%"))[1].brightness
    settings = Radiosity(method="shooting", rays=2048, patches="4%", residual="0.2%")
    other = solved(lit(True), settings)[1].brightness
    inside = one[0::2], other[0::2]
    # What is unshot is at most 0.2 % of what lamps emit; the rest is the noise of the counts.
    assert np.abs(one - other).max() < 0.02 * one.max()
    assert np.abs(inside[0] / inside[1] - 1).max() < 0.06
    assert abs(inside[0].sum() / inside[1].sum() - 1) < 0.005


def test_light_can_be_followed_bounce_by_bounce() -> None:
    factors = csr_array(np.array([[0, 1.0], [1.0, 0]]))
    emitted, half = np.array([[1.0], [0.0]]), np.full((2, 1), 0.5)
    bounces = [brightness(factors, emitted, half, n)[:, 0].tolist() for n in range(3)]
    assert bounces == [[1, 0], [1, 0.5], [1.25, 0.5]]
    whole = brightness(factors, emitted, half)[:, 0]
    assert np.allclose(whole, [4 / 3, 2 / 3], rtol=1e-12, atol=0)


def test_the_committed_table_is_within_one_per_cent_of_mitsuba() -> None:
    folder = Path(__file__).parents[2] / "experiments"
    rows = read_csv(folder / "rays" / "patches.csv", ["mitsuba", "difference"])
    theirs = read_csv(folder / "path" / "cornell.csv", ["mitsuba"])
    assert [row["mitsuba"] for row in rows] == [row["mitsuba"] for row in theirs]
    assert all(abs(float(row["difference"].rstrip("%"))) < 1 for row in rows)
