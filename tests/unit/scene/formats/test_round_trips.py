"""Random polygons, written in every format, are the triangles that NFF has of them."""

import gzip
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mesh_files import SQUARE, area, corners_of, obj, off, ply, read, stl, stl_text

from simmpp.common.errors import SceneError
from simmpp.scene import packed
from simmpp.scene.mesh import load_mesh
from simmpp.scene.nff import load_nff, read_nff, write_nff
from simmpp.scene.scene import Polygon
from simmpp.scene.tiling import are_convex
from simmpp.scene.triangles import _dominant_plane, _is_convex, triangles

KEEP = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
GRID = st.integers(-3, 3)
REALS = st.floats(-1e30, 1e30) | st.floats(-1, 1) | GRID.map(float)
SHORT_REALS = (
    st.floats(-(2.0**99), 2.0**99, width=32) | st.floats(-1, 1, width=32) | GRID.map(float)
)


@st.composite
def polygons(draw: Any, reals: st.SearchStrategy[Any]) -> tuple[list[Any], list[list[int]]]:
    """Vertices and polygons, flat ones and bent ones, some whose edges cross."""
    vertices = draw(st.lists(st.tuples(reals, reals, reals), min_size=3, max_size=9))
    corners = st.integers(0, len(vertices) - 1)
    few = st.lists(st.lists(corners, min_size=3, max_size=7), min_size=1, max_size=4)
    alike = st.lists(st.lists(corners, min_size=4, max_size=4), min_size=4, max_size=9)
    faces = few | alike
    return [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), *vertices], [[0, 1, 2], *draw(faces)]


def expected(vertices: list[Any], faces: list[list[int]]) -> np.ndarray:
    points = np.array(vertices, dtype=np.float64)
    return np.concatenate([triangles(Polygon(points[face])) for face in faces])


@KEEP
@given(polygons(REALS))
def test_texts_and_doubles(tmp_path: Path, soup: Any) -> None:
    triangles_of_nff = expected(*soup)
    files = {"a.obj": obj(*soup), "a.off": off(*soup)}
    files |= {f"{i}.ply": ply(*soup, order, "double") for i, order in enumerate(["", "<", ">"])}
    for name, content in files.items():
        found = corners_of(read(tmp_path, name, content))
        np.testing.assert_array_equal(found, triangles_of_nff, err_msg=name)


@KEEP
@given(polygons(SHORT_REALS))
def test_floats(tmp_path: Path, soup: Any) -> None:
    triangles_of_nff = expected(*soup)
    files = {f"{i}.ply": ply(*soup, order) for i, order in enumerate(["", "<", ">"])}
    files |= {"b.stl": stl(triangles_of_nff), "t.stl": stl_text(triangles_of_nff)}
    for name, content in files.items():
        found = corners_of(read(tmp_path, name, content))
        np.testing.assert_array_equal(found, triangles_of_nff, err_msg=name)


@KEEP
@given(st.lists(st.tuples(*[st.tuples(GRID, GRID, GRID)] * 3), min_size=1, max_size=20))
def test_trimesh_reads_the_same_triangles(tmp_path: Path, corners: Any) -> None:
    corners = np.array([((0, 0, 0), (1, 0, 0), (0, 1, 0)), *corners], dtype=np.float64)
    vertices = corners.reshape(-1, 3).tolist()
    faces = np.arange(len(vertices)).reshape(-1, 3).tolist()
    files = {"a.obj": obj(vertices, faces), "a.off": off(vertices, faces)}
    files |= {"b.ply": ply(vertices, faces, "<"), "b.stl": stl(corners), "t.stl": stl_text(corners)}
    for name, content in files.items():
        found = corners_of(read(tmp_path, name, content))
        again = trimesh.load_mesh(tmp_path / name, process=False).triangles
        np.testing.assert_array_equal(found, again, err_msg=name)


@given(st.integers(4, 7), st.data())
def test_many_polygons_are_convex_as_each_is(n: int, data: st.DataObject) -> None:
    points = st.tuples(REALS, REALS, REALS) | st.tuples(GRID, GRID, st.just(0))
    rows = st.lists(st.lists(points, min_size=n, max_size=n), min_size=1, max_size=5)
    polygons = np.array(data.draw(rows), dtype=np.float64)
    each = [_is_convex(_dominant_plane(polygon)) for polygon in polygons]
    assert are_convex(polygons).tolist() == each


def test_a_bent_quad_keeps_both_halves(tmp_path: Path) -> None:
    """Seen along its largest axis its edges cross: without one half there would be a hole."""
    bent = [(0, 0, 0), (0.35, 0.8, -0.11), (0.29, 0.52, -0.07), (0, -0.22, -0.24)]
    corners = corners_of(read(tmp_path, "a.obj", obj(bent, [range(4)])))
    np.testing.assert_array_equal(corners, np.array(bent)[[(0, 1, 2), (0, 2, 3)]])


@KEEP
@given(polygons(st.floats(-1e28, 1e28) | st.floats(-1e-5, 1e-5) | st.floats(1e6, 1e6 + 1)))
def test_a_mesh_written_as_nff_is_the_same_triangles(tmp_path: Path, soup: Any) -> None:
    scene = read(tmp_path, "a.obj", obj(*soup))
    again = read_nff(write_nff(scene), name="a", where="a.nff")
    np.testing.assert_array_equal(corners_of(again), corners_of(scene))
    assert again.camera == scene.camera and again.lights == scene.lights


# --- packed files ---


@pytest.mark.parametrize("name", ["a.obj", "a.off", "a.ply", "a.nff"])
def test_packed(tmp_path: Path, name: str) -> None:
    soup = SQUARE, [range(4)]
    scene = read(tmp_path, "a.obj", obj(*soup))
    contents = {"a.obj": obj(*soup), "a.off": off(*soup), "a.ply": ply(*soup, "<")}
    content = contents.get(name) or write_nff(scene).encode()
    (tmp_path / f"{name}.GZ").write_bytes(gzip.compress(content[:50]) + gzip.compress(content[50:]))
    again = (load_nff if "nff" in name else load_mesh)(tmp_path / f"{name}.GZ")
    assert area(corners_of(again)) == 1
    assert again.name == ("a" if "nff" in name else f"{name}.GZ:components")


@pytest.mark.parametrize("load", [load_mesh, load_nff])
def test_broken_packages(tmp_path: Path, load: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    content = gzip.compress(obj(SQUARE, [range(4)]) * 99)
    broken = {
        "cut.obj.gz": (content[:-9], "the gzip file is cut off: its end is missing"),
        "none.obj.gz": (b"v 0 0 0\n", "not a readable gzip file: Not a gzipped file (b'v ')"),
        "bytes.obj.gz": (content[:20] + b"\xff\xff" + content[22:], "not a readable gzip file: "),
        "sum.obj.gz": (content[:-8] + bytes(8), "not a readable gzip file: CRC check failed"),
    }
    for name, (data, problem) in broken.items():
        (tmp_path / name).write_bytes(data)
        with pytest.raises(SceneError) as caught:
            load(tmp_path / name)
        assert str(caught.value).startswith(f"{tmp_path / name}: {problem}")
    monkeypatch.setattr(packed, "LARGEST_UNPACKED_BYTES", 10_000_000)
    (tmp_path / "bomb.ply.gz").write_bytes(gzip.compress(bytes(10_000_001)))
    with pytest.raises(SceneError, match=r"unpacks to more than 10000000 bytes: unpack it first$"):
        load(tmp_path / "bomb.ply.gz")
