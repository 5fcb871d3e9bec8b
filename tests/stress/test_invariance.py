"""Neither unit nor place of a scene counts, as long as its coordinates are exact.

Scaled by a power of two, or moved by an offset that every coordinate bears, a scene has the same
rays, hits, itineraries, owners and residents, bit for bit; distances and centres are scaled.
"""

from __future__ import annotations

import dataclasses
import os
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from transforms import moved, scaled

import simmpp
from simmpp.common.errors import SceneError
from simmpp.scene.mesh import load_mesh
from simmpp.scene.nff import read_nff
from simmpp.scene.scene import Camera, Cone, Light, Material, MeshPart, Polygon, Scene, Sphere
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.embree import Intersector
from simmpp.workload.trace.frame import frame_of
from simmpp.workload.trace.shading import render
from simmpp.workload.trace.tracer import trace
from simmpp.workload.workload import Workload

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "40"))
PICTURE = simmpp.Picture(resolution=12, max_depth=3)
GENERATED = ("mountain:3", "rings:1", "tetra:4", "balls:2", "gears:1", "lattice:2", "jacks:1")
GRID = 2.0**-10
"""Coordinates below are multiples of it, ..."""
FARTHEST = 2**51
"""... and the largest offset is this many: sums fill 53 bits."""
MATERIALS = (Material(), Material(ks=0.5), Material(ks=0.1, transmittance=0.9, ior=1.5))


class NoProposals(Intersector):
    """Embree says nothing: float64 searches without a bound."""

    def claims(self, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
        return np.full((len(origins), 2), -1, dtype=np.int32)


def compare(here: Workload, there: Workload, size: float = 1.0) -> None:
    """Equal in all that engines and policies read; lengths ``size`` times as large."""
    for field in dataclasses.fields(Workload):
        one, other = getattr(here, field.name), getattr(there, field.name)
        if isinstance(one, np.ndarray):
            if field.name in ("hit_distances", "object_centroids"):
                one = one * size
            assert one.tobytes() == other.tobytes(), field.name
    for rules in (
        simmpp.PlacementRules(owners="bisection"),
        simmpp.PlacementRules(owners="morton", pixels="tiles"),
    ):
        memory = simmpp.Memory(fraction=Fraction(1, 3), residents="nearest")
        one, other = (simmpp.place(each, 5, memory, rules, seed=0) for each in (here, there))
        assert one.owners.tobytes() == other.owners.tobytes()
        assert one.replica_objects.tobytes() == other.replica_objects.tobytes()


@pytest.mark.parametrize("power", [-40, -1, 1, 23, 40])
@pytest.mark.parametrize("name", GENERATED)
def test_generated_scenes_in_other_units(name: str, power: int) -> None:
    scene, size = load_scene(name), 2.0**power
    there = scaled(scene, size)
    here, far = trace(scene, PICTURE), trace(there, PICTURE)
    compare(here, far, size)
    assert np.array_equal(render(scene, PICTURE, here), render(there, PICTURE, far))


# --- any scene on a grid ---

steps = st.integers(-(2**13), 2**13)
points = st.tuples(steps, steps, steps).map(lambda p: (p[0] * GRID, p[1] * GRID, p[2] * GRID))
radii = st.integers(0, 2**12).map(lambda r: r * GRID)
materials = st.integers(0, len(MATERIALS) - 1)


def arrays(least: int, most: int) -> st.SearchStrategy[np.ndarray]:
    return st.lists(points, min_size=least, max_size=most).map(np.array)


@st.composite
def polygons(draw: st.DrawFn) -> Polygon:
    """A star in a plane along an axis: concave, with a dent at every other corner."""
    corners = draw(st.integers(3, 9))
    reach = draw(st.lists(st.integers(1, 2**12), min_size=corners, max_size=corners))
    angles = 2 * np.pi * np.arange(corners) / corners
    flat = np.rint(np.stack([np.cos(angles), np.sin(angles)], axis=1) * np.array(reach)[:, None])
    star = np.insert(flat * GRID, draw(st.integers(0, 2)), 0.0, axis=1)
    return Polygon(star + draw(points), None, draw(materials))


@st.composite
def meshes(draw: st.DrawFn) -> MeshPart:
    vertices = draw(arrays(3, 9))
    corners = st.integers(0, len(vertices) - 1)
    faces = draw(st.lists(st.tuples(corners, corners, corners), min_size=1, max_size=20))
    return MeshPart(vertices, np.array(faces, np.int32), draw(materials))


objects = (
    st.builds(Sphere, points, radii, materials)
    | st.builds(Cone, points, radii, points, radii, materials)
    | polygons()
    | meshes()
)


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    things = draw(st.lists(objects, max_size=12))
    lights = draw(st.lists(points, max_size=2))
    camera = Camera(eye=(0.5, -20.0, 0.25), at=draw(points), up=(0.0, 0.0, 1.0))
    return Scene("grid", tuple(things), MATERIALS, tuple(map(Light, lights)), camera)


far_steps = st.integers(-FARTHEST, FARTHEST) | st.sampled_from([0, FARTHEST, -FARTHEST])


@settings(max_examples=CASES)
@given(
    scene=scenes(),
    offset=st.tuples(far_steps, far_steps, far_steps),
    power=st.integers(-40, 40),
)
def test_any_scene_elsewhere_and_in_other_units(
    scene: Scene, offset: tuple[int, int, int], power: int
) -> None:
    here = trace(scene, PICTURE)
    compare(here, trace(scene, PICTURE, intersector=NoProposals))
    there = moved(scene, tuple(step * GRID for step in offset))
    assert moved(there, tuple(-step * GRID for step in offset)).camera == scene.camera  # exact
    compare(here, trace(there, PICTURE))
    compare(here, trace(scaled(there, 2.0**power), PICTURE), 2.0**power)


def test_the_largest_and_smallest_units() -> None:
    scene = load_scene("gears:1")
    here = trace(scene, PICTURE)
    for power in (-890, 890):
        compare(here, trace(scaled(scene, 2.0**power), PICTURE), 2.0**power)
    for power in (-910, 910, -1060, 1020):
        with pytest.raises(
            SceneError, match=r"extent is .*: expected 0, or from 1e-271 to 8e\+270"
        ):
            frame_of(scaled(scene, 2.0**power))


# --- through files ---


def nff(scene: Scene) -> str:
    """The scene with every digit that float64 has, unlike the SPD's six."""
    c = scene.camera
    lines = [["v from", *c.eye, "at", *c.at, "up", *c.up, "angle", c.angle_degrees]]
    lines += [["l", *light.position] for light in scene.lights]
    for item in scene.objects:
        m = scene.materials[item.material]
        lines.append(["f", *m.colour, m.kd, m.ks, m.shine, m.transmittance, m.ior])
        if isinstance(item, Sphere):
            lines.append(["s", *item.centre, item.radius])
        elif isinstance(item, Cone):
            lines.append(["c", *item.base, item.base_radius, *item.apex, item.apex_radius])
        elif isinstance(item, Polygon):
            lines.append(["p", len(item.vertices), *item.vertices.ravel().tolist()])
    return "\n".join(" ".join(map(str, line)) for line in lines)


@pytest.mark.parametrize("power", [-40, 40])
@pytest.mark.parametrize("name", ["mountain:3", "rings:1", "gears:1"])
def test_nff_files_in_other_units(name: str, power: int) -> None:
    scene, size = load_scene(name), 2.0**power
    there = read_nff(nff(scaled(scene, size)), name="there", where="there.nff")
    compare(trace(scene, PICTURE), trace(there, PICTURE), size)


def wavy(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices on a grid, of two sheets of n x n squares, and faces."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(n + 1), np.arange(n + 1)))
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.concatenate([corner[:, None] + [0, 1, n + 2], corner[:, None] + [n + 2, n + 1, 0]])
    height = np.rint(np.sin(x) * np.cos(y) * 300) / 1024
    sheet = np.stack([x, y, height], axis=1).astype(float)
    both = np.concatenate([sheet, sheet + np.array([0.5, 0.25, 1.0])])
    return both, np.concatenate([faces, faces + len(sheet)])


def obj(path: Path, vertices: np.ndarray, faces: np.ndarray) -> Path:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"f {i} {j} {k}" for i, j, k in (faces + 1).tolist()]
    path.write_text("\n".join(lines))
    return path


@pytest.mark.parametrize("cut", ["nodes", "components", {"clusters": 7}], ids=str)
def test_meshes_in_other_units_and_elsewhere(tmp_path: Path, cut: object) -> None:
    vertices, faces = wavy(9)
    scene = load_mesh(obj(tmp_path / "here.obj", vertices, faces), objects=cut)
    here = trace(scene, PICTURE)
    for power in (-40, 40):
        there = obj(tmp_path / "there.obj", vertices * 2.0**power, faces)
        compare(here, trace(load_mesh(there, objects=cut), PICTURE), 2.0**power)
    offset = (2.0**40, -(2.0**39), 3 * 2.0**38)
    there = load_mesh(obj(tmp_path / "there.obj", vertices + offset, faces), objects=cut)
    # The camera is ours, not the file's, and its eye has more digits than the vertices.
    camera = dataclasses.replace(scene.camera, eye=(-3.0, -4.5, 9.0), at=(4.0, 4.0, 0.0))
    scene = dataclasses.replace(scene, camera=camera, lights=(Light((-8.0, 2.0, 16.0)),))
    expected = moved(scene, offset)
    there = dataclasses.replace(there, camera=expected.camera, lights=expected.lights)
    compare(trace(scene, PICTURE), trace(there, PICTURE))


@pytest.mark.parametrize("name", ["mountain:4", "tetra:5", "gears:1", "lattice:2", "rings:2"])
def test_owners_do_not_hang_on_roundings(name: str) -> None:
    """Units of ten and offsets round all coordinates; where centres are equal, ids still decide."""
    scene = load_scene(name)
    places = [scaled(scene, 1e-6), scaled(scene, 1e3), scaled(scene, 0.0254)]
    places += [moved(scene, (1234.56, -99.1, 7.7)), moved(scene, (1e5 / 3, 1e6 / 7, -3e5 / 11))]
    picture = simmpp.Picture(resolution=1, max_depth=1)
    for processors in (2, 8, 37, 64, 512):
        owners = [
            simmpp.place(
                trace(each, picture), processors, simmpp.Memory(), simmpp.PlacementRules(), 0
            ).owners
            for each in (scene, *places)
        ]
        for other in owners[1:]:
            assert np.array_equal(owners[0], other)
