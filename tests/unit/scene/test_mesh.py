"""Meshes written by trimesh, read back and cut."""

import hashlib
import math
import os
import re
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import trimesh

from simmpp.common.errors import SceneError
from simmpp.scene.boxes import scene_box
from simmpp.scene.mesh import load_mesh
from simmpp.scene.scene import Floats, Material, MeshPart, Scene
from simmpp.scene.triangles import triangles

FORMATS = ("glb", "obj", "stl", "ply", "off")
RED_MIRROR = trimesh.visual.material.PBRMaterial(
    baseColorFactor=[255, 0, 0, 255], metallicFactor=1.0, roughnessFactor=0.1
)


def box_at(x: float) -> trimesh.Trimesh:
    box = trimesh.creation.box(extents=(1, 1, 1))
    box.apply_translation((x, 0, 0))
    return box


@pytest.fixture
def two_boxes(tmp_path: Path) -> Path:
    """The same two boxes in every format, and as two nodes in nodes.glb and nodes.obj."""
    both = trimesh.util.concatenate([box_at(0), box_at(3)])
    for kind in FORMATS:
        both.export(tmp_path / f"two.{kind}")
    scene = trimesh.Scene({"right": box_at(3), "left": box_at(0)})
    for kind in ("glb", "obj"):
        scene.export(tmp_path / f"nodes.{kind}")
    return tmp_path


def corners(scene: Scene) -> list[Floats]:
    return [triangles(part) for part in scene.objects]


def sorted_triangles(points: Floats) -> Floats:
    rows = points.reshape(-1, 9).round(5)
    return rows[np.lexsort(rows.T)]


def parts(scene: Scene) -> list[MeshPart]:
    return [part for part in scene.objects if isinstance(part, MeshPart)]


@pytest.mark.parametrize("kind", FORMATS)
def test_components(two_boxes: Path, kind: str) -> None:
    scene = load_mesh(two_boxes / f"two.{kind}")
    assert scene.name == f"two.{kind}:components"
    assert [part.vertices.shape for part in parts(scene)] == [(8, 3), (8, 3)]
    assert [part.faces.shape for part in parts(scene)] == [(12, 3), (12, 3)]
    centres = [points.reshape(-1, 3).mean(axis=0).round(6).tolist() for points in corners(scene)]
    assert centres == [[0, 0, 0], [3, 0, 0]]


@pytest.mark.parametrize("kind", FORMATS)
def test_nodes_keep_a_mesh_whole(two_boxes: Path, kind: str) -> None:
    scene = load_mesh(two_boxes / f"two.{kind}", objects="nodes")
    assert [part.faces.shape for part in parts(scene)] == [(24, 3)]


def test_nodes_come_by_name(two_boxes: Path) -> None:
    scene = load_mesh(two_boxes / "nodes.obj", objects="nodes")
    assert [part.name for part in parts(scene)] == ["left", "right"]
    assert corners(scene)[0].mean() == pytest.approx(0, abs=1e-6)


def test_nodes_of_gltf_come_as_in_the_file(two_boxes: Path) -> None:
    scene = load_mesh(two_boxes / "nodes.glb", objects="nodes")
    assert [part.name for part in parts(scene)] == ["right", "left"]
    assert corners(scene)[1].mean() == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize("k", [1, 5, 24, 100])
def test_clusters(two_boxes: Path, kind: str, k: int) -> None:
    scene = load_mesh(two_boxes / f"two.{kind}", objects={"clusters": k})
    sizes = [len(part.faces) for part in parts(scene)]
    assert sum(sizes) == 24 and max(sizes) <= k
    assert len(sizes) == {1: 24, 5: 8, 24: 1, 100: 1}[k]


@pytest.mark.parametrize("objects", ["nodes", "components", {"clusters": 3}])
def test_no_cut_loses_or_moves_a_triangle(two_boxes: Path, objects: object) -> None:
    expected = trimesh.util.concatenate([box_at(0), box_at(3)]).triangles
    scene = load_mesh(two_boxes / "two.ply", objects=objects)
    found = np.concatenate(corners(scene))
    np.testing.assert_array_equal(sorted_triangles(found), sorted_triangles(expected))


def test_placed_and_mirrored_nodes(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    ball = trimesh.creation.icosphere(1)
    scene.add_geometry(ball, node_name="a")
    mirrored = np.diag([-1.0, 1, 1, 1])
    mirrored[:3, 3] = (5, 0, 0)
    scene.add_geometry(ball, node_name="b", transform=mirrored)
    scene.export(tmp_path / "s.glb")
    for points in corners(load_mesh(tmp_path / "s.glb", objects="nodes")):
        centre = points.reshape(-1, 3).mean(axis=0)
        normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        assert ((points.mean(axis=1) - centre) * normals).sum(axis=1).min() > 0, "inside out"


def test_materials(tmp_path: Path) -> None:
    mirror, plain, painted = box_at(0), box_at(3), box_at(6)
    mirror.visual = trimesh.visual.TextureVisuals(material=RED_MIRROR)
    painted.visual.vertex_colors = [0, 255, 0, 255]
    trimesh.Scene({"a": mirror, "b": plain, "c": painted}).export(tmp_path / "m.glb")
    scene = load_mesh(tmp_path / "m.glb")
    assert scene.materials == (
        Material((1, 0, 0), kd=0.5, ks=0.5),
        Material(),
        Material((0, 1, 0)),
    )
    assert [part.material for part in parts(scene)] == [0, 1, 2]
    assert [scene.materials[i].reflects for i in range(3)] == [True, False, False]


@pytest.mark.parametrize("kind", ["stl", "ply"])
def test_the_camera_sees_the_whole_bounding_sphere(tmp_path: Path, kind: str) -> None:
    slab = trimesh.creation.box(extents=(10, 0.5, 3))
    slab.apply_translation((100, -20, 7))
    slab.export(tmp_path / f"slab.{kind}")
    scene = load_mesh(tmp_path / f"slab.{kind}")
    low, high = scene_box(scene.objects)
    radius, camera = math.dist(low, high) / 2, scene.camera
    np.testing.assert_allclose(camera.at, (low + high) / 2)
    assert camera.up == ((0, 0, 1) if kind == "stl" else (0, 1, 0))
    half_angle = math.degrees(math.asin(radius / math.dist(camera.eye, camera.at)))
    assert 0.9 * camera.angle_degrees / 2 < half_angle < camera.angle_degrees / 2
    assert len(scene.lights) == 2
    for light in scene.lights:
        assert math.dist(light.position, camera.at) > 2 * radius


def test_degenerate_and_duplicate_triangles_are_kept(tmp_path: Path) -> None:
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\nf 1 1 2\n"
    (tmp_path / "d.obj").write_text(text)
    (part,) = parts(load_mesh(tmp_path / "d.obj"))
    assert len(part.faces) == 3


BROKEN = {
    "empty.obj": (b"", "no triangles"),
    "empty.glb": (b"", "not a readable glb mesh"),
    "text.glb": (b"hello", "not a readable glb mesh"),
    "text.stl": (b"hello there", "no"),
    "short.ply": (b"ply\nformat ascii 1.0\nelement vertex 3\n", "not a readable ply mesh"),
    "nan.obj": (b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "is not a finite number"),
    "inf.ply": (
        b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        b"property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        b"inf 0 0\n1 nan 0\n0 1e39 0\n3 0 1 2\n",
        "is not a finite number",
    ),
    "huge.obj": (b"v 1e300 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "is not a finite number"),
    "index.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "not a readable obj mesh"),
    "point.obj": (b"v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "all vertices are the same point"),
    "points.ply": (
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        b"property float z\nend_header\n0 0 0\n",
        "no triangles",
    ),
    "scene.foo": (
        b"x",
        "neither NFF (.nff) nor a mesh that is read (glb, gltf, obj, off, ply, stl, or .gz of one)",
    ),
}


@pytest.mark.parametrize("name", sorted(BROKEN))
def test_broken_files(tmp_path: Path, name: str) -> None:
    data, problem = BROKEN[name]
    (tmp_path / name).write_bytes(data)
    with pytest.raises(SceneError) as caught, warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)  # users would see them beside the one line
        load_mesh(tmp_path / name)
    message = str(caught.value)
    assert re.match(rf"{re.escape(str(tmp_path / name))}(:\d+)?: ", message) and problem in message
    assert "\n" not in message


@pytest.mark.parametrize("kind", ["glb", "stl", "ply"])
def test_truncated_files(two_boxes: Path, kind: str) -> None:
    whole = (two_boxes / f"two.{kind}").read_bytes()
    file = two_boxes / f"cut.{kind}"
    for share in (0.1, 0.5, 0.9):
        file.write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(SceneError):
            load_mesh(file)


DIGEST = """
import hashlib, sys
from simmpp.scene.mesh import load_mesh
scene = load_mesh(sys.argv[1], objects="components")
digest = hashlib.sha256()
for part in scene.objects:
    digest.update(part.name.encode() + part.vertices.tobytes() + part.faces.tobytes())
print(digest.hexdigest())
"""


def test_the_order_of_objects_does_not_depend_on_the_hash_seed(two_boxes: Path) -> None:
    digests = set()
    for seed in ("1", "2"):
        call = [sys.executable, "-c", DIGEST, str(two_boxes / "nodes.glb")]
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        digests.add(subprocess.check_output(call, env=environment, text=True))
    assert len(digests) == 1 and digests != {hashlib.sha256().hexdigest()}
