"""PLY: text and both byte orders, whatever elements and properties stand around the faces."""

import struct
from pathlib import Path

import numpy as np
import pytest
from mesh_files import SQUARE, U, corners_of, facts, ply, ply_header, read

from simmpp.common.errors import SceneError
from simmpp.scene.formats import ply_body
from simmpp.scene.scene import Material

ORDERS = ["", "<", ">"]
XYZ = "property float x\nproperty float y\nproperty float z\n"
FACES = "property list uchar int vertex_indices\n"
POINTS = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
RGB = "property uchar red\nproperty uchar green\nproperty uchar blue\n"


def text(vertex: str, face: str, body: str, n_vertices: int = 4, n_faces: int = 1) -> bytes:
    """A PLY text with these properties."""
    head = f"ply\nformat ascii 1.0\nelement vertex {n_vertices}\n{vertex}"
    return f"{head}element face {n_faces}\n{face}end_header\n{body}".encode()


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("real", ["float", "double"])
def test_orders(tmp_path: Path, order: str, real: str) -> None:
    polygons = [(0, 1, 2, 3), (3, 2, 4), (0, 1), (0, 1, 2)]
    scene = read(tmp_path, "a.ply", ply([*SQUARE, (0.5, 2, 0)], polygons, order, real))
    assert facts(scene) == (4, 2)
    assert facts(read(tmp_path, "u.ply", ply(U, [range(8)], order))) == (6, 7)


@pytest.mark.parametrize("order", ORDERS)
def test_numbers_are_of_the_type_that_is_declared(tmp_path: Path, order: str) -> None:
    vertices = [(0.1, 0.2, 0.3), (1 / 3, 0, 0), (0, 2 / 3, 0)]
    for real, kind in (("float", np.float32), ("double", np.float64)):
        scene = read(tmp_path, "a.ply", ply(vertices, [range(3)], order, real))
        expected = np.array(vertices, dtype=kind).astype(np.float64)
        np.testing.assert_array_equal(corners_of(scene), [expected])


READ = {
    "quad": (text(XYZ, FACES, POINTS + "4 0 1 2 3\n"), 2, 1),
    "rows over several lines": (text(XYZ, FACES, POINTS.replace(" ", "\n") + "4 0 1\n2 3"), 2, 1),
    "CRLF": (text(XYZ, FACES, POINTS + "4 0 1 2 3\n").replace(b"\n", b"\r\n"), 2, 1),
    "CR": (text(XYZ, FACES, POINTS + "4 0 1 2 3\n").replace(b"\n", b"\r"), 2, 1),
    "byte order mark": (b"\xef\xbb\xbf" + text(XYZ, FACES, POINTS + "4 0 1 2 3\n"), 2, 1),
    "Latin-1": (
        text(XYZ, FACES, POINTS + "4 0 1 2 3\n").replace(b"element", b"comment \xf6\nelement", 1),
        2,
        1,
    ),
    "a line without comment": (
        text(XYZ, FACES, POINTS + "4 0 1 2 3\n").replace(b"element", b"Created by x\nelement", 1),
        2,
        1,
    ),
    "sized types, vertex_index": (
        text(
            XYZ.replace("float", "float32"),
            "property list uint8 int32 vertex_index\n",
            POINTS + "4 0 1 2 3\n",
        ),
        2,
        1,
    ),
    "axes in another order, normals between": (
        text(
            "property double z\nproperty float nx\nproperty double x\nproperty double y\n",
            FACES,
            "9 0.5 0 0\n9 0.5 1 0\n9 0.5 1 1\n9 0.5 0 1\n4 0 1 2 3\n",
        ),
        2,
        1,
    ),
    "lists of vertices and other lists of faces": (
        text(
            "property list uchar float w\n" + XYZ,
            "property float q\nproperty list uchar float uv\n" + FACES + "property uchar k\n",
            "0 0 0 0\n1 9 1 0 0\n2 9 9 1 1 0\n0 0 1 0\n"
            "0.5 2 0.1 0.2 4 0 1 2 3 7\n1.5 0 3 0 1 2 8\n",
            n_faces=2,
        ),
        3,
        1.5,
    ),
    "other elements": (
        b"ply\nformat ascii 1.0\nobj_info x\n\nelement material 2\nproperty list uchar int a\n"
        b"property char b\nelement vertex 4\n" + XYZ.encode() + b"element nothing 5\n"
        b"element face 1\n" + FACES.encode() + b"element edge 1\nproperty int a\nend_header\n"
        b"2 5 5 1\n0 2\n" + POINTS.encode() + b"4 0 1 2 3\n-1\n",
        2,
        1,
    ),
    "no faces but strips": (
        text(XYZ, FACES, POINTS + "6 0 1 3 2 -1 0\n").replace(b"face", b"tristrips"),
        2,
        1,
    ),
}


@pytest.mark.parametrize("name", READ)
def test_read(tmp_path: Path, name: str) -> None:
    content, n, of_area = READ[name]
    assert facts(read(tmp_path, "a.ply", content)) == (n, of_area)


@pytest.mark.parametrize("order", "<>")
def test_binary_rows_of_any_layout(tmp_path: Path, order: str) -> None:
    """Lists of different lengths before, between and behind what is read."""
    head = ply_header(order, 4, 3).decode()
    head = head.replace("property float x", "property list ushort double w\nproperty float x")
    head = head.replace("end_header", "property list int short more\nproperty uchar k\nend_header")
    rows = [struct.pack(f"{order}H{i}d3f", i, *[0.5] * i, *point) for i, point in enumerate(SQUARE)]
    for i, polygon in enumerate([(0, 1, 2, 3), (0, 1, 2), (2, 3, 0)]):
        n = len(polygon)
        rows.append(struct.pack(f"{order}B{n}ii{i}hB", n, *polygon, i, *[7] * i, 9))
    scene = read(tmp_path, "a.ply", head.encode() + b"".join(rows))
    assert facts(scene) == (4, 2)


@pytest.mark.parametrize("line_end", [b"\n", b"\r\n", b"\r"])
def test_a_body_that_begins_like_a_line_end(tmp_path: Path, line_end: bytes) -> None:
    content = ply([(struct.unpack("<f", b"\n\r\n\0")[0], 0, 0), *SQUARE[1:]], [range(4)], "<")
    head, end, body = content.partition(b"end_header\n")
    whole = (head + end).replace(b"\n", line_end) + body
    assert len(corners_of(read(tmp_path, "a.ply", whole))) == 2


def test_strips_turn_every_second_triangle(tmp_path: Path) -> None:
    vertices = [(x, y, 0) for x in range(4) for y in (1, 0)]
    strips = ["8 0 1 2 3 4 5 6 7", "9 -1 0 1 2 3 -1 4 5 6", "7 0 1 2 2 2 3 4", "0", "2 0 1"]
    body = "".join(f"{x} {y} {z}\n" for x, y, z in vertices) + "\n".join(strips)
    content = text(XYZ, FACES, body, 8, len(strips)).replace(b"face", b"tristrips")
    corners = corners_of(read(tmp_path, "a.ply", content))
    assert len(corners) == 6 + 3 + 2
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    np.testing.assert_array_equal(sides, [(0, 0, 1)] * 11), "all seen from the same side"


# --- colours ---

BYTES = "255 0 0", "255 0 0", "0 0 255", "0 0 255"
PAINTED = {
    "uchar": (BYTES, (0.5, 0, 0.5)),
    "int": (BYTES, (0.5, 0, 0.5)),
    "ushort": (("65535 0 0",) * 4, (1, 0, 0)),
    "float": (("1 0 0", "0.1 0 0", "2 0 0", "nan 0 0"), ((255 + 26 + 255) / 4 / 255, 0, 0)),
}


@pytest.mark.parametrize("kind", PAINTED)
def test_colours_of_vertices(tmp_path: Path, kind: str) -> None:
    colours, expected = PAINTED[kind]
    body = "".join(
        f"{row} {colour}\n" for row, colour in zip(POINTS.splitlines(), colours, strict=True)
    )
    content = text(XYZ + RGB.replace("uchar", kind), FACES, body + "4 0 1 2 3\n")
    (material,) = read(tmp_path, "a.ply", content).materials
    assert material == Material(pytest.approx(expected))


def test_colours_of_faces_where_vertices_have_none(tmp_path: Path) -> None:
    faces = text(XYZ, FACES + RGB, POINTS + "4 0 1 2 3 0 255 0\n3 0 1 2 0 0 0\n", n_faces=2)
    assert read(tmp_path, "a.ply", faces).materials == (Material((0, 0.5, 0)),)
    half = text(XYZ, FACES + "property uchar red\n", POINTS + "4 0 1 2 3 9\n")
    assert read(tmp_path, "a.ply", half).materials == (Material(),)


# --- refused ---

GOOD = text(XYZ, FACES, POINTS + "4 0 1 2 3\n")
HEAD = GOOD[: GOOD.index(b"end_header")]
REFUSED = [
    (b"", 1, "the header ends without end_header"),
    (b"plx\n", 1, "expected a line of a PLY header, got 'plx'"),
    (b"ply\nformat ascii 1.0\nelement vertex 3\n", 3, "the header ends without end_header"),
    (b"ply\nelement vertex 1\n", 2, "got 'element vertex 1'"),
    (b"ply\nformat ascii 2.0\n", 2, "got 'format ascii 2.0'"),
    (b"ply\nformat binary 1.0\n", 2, "got 'format binary 1.0'"),
    (b"ply\nformat ascii 1.0\nproperty float x\n", 3, "got 'property float x'"),
    (b"ply\nformat ascii 1.0\nelement vertex -1\n", 3, "got 'element vertex -1'"),
    (b"ply\nformat ascii 1.0\nelement vertex " + b"9" * 99 + b"\n", 3, "got 'element vertex 999"),
    (HEAD + b"property half x\n", 9, "got 'property half x'"),
    (HEAD + b"property list float int x\n", 9, "got 'property list float int x'"),
    (HEAD + b"nonsense\n", 9, "got 'nonsense'"),
    (
        text(XYZ, FACES, POINTS + "4 0 1 2 3\n", n_faces=3),
        0,
        "the header says 3 faces, 1 are there",
    ),
    (text(XYZ, FACES, POINTS + "4 0 1 2\n"), 0, "the header says 1 faces, 0 are there"),
    (text(XYZ, FACES, POINTS, n_vertices=9), 0, "the header says 9 vertices, 4 are there"),
    (text(XYZ, FACES, POINTS + "4 0 1 2 3\n", n_faces=10**17), 0, "says 100000000000000000 faces"),
    (GOOD + b"3 0 1 2\n", 15, "after the last row that the header says there is more"),
    (text(XYZ, FACES, POINTS + "4 0 1 2 4\n"), 14, "face 1 names vertex 4, expected 0 to 3"),
    (text(XYZ, FACES, POINTS + "4 0 1 2 -1\n"), 14, "face 1 names vertex -1"),
    (text(XYZ, FACES, POINTS + "-1 0 1 2\n"), 14, "row 1 of 'face' has a list of -1 numbers"),
    (text(XYZ, FACES, POINTS + "x 0 1 2 3\n"), 14, "expected a whole number, got 'x'"),
    (text(XYZ, FACES, POINTS + "4 0 1 2 3.0\n"), 14, "expected a whole number, got '3.0'"),
    (text(XYZ, FACES, "0 0 nan" + POINTS[5:] + "4 0 1 2 3\n"), 10, "vertex 1 (0, 0, nan) is not"),
    (text(XYZ, FACES, "0 0 1e39" + POINTS[5:] + "4 0 1 2 3\n"), 10, "vertex 1 (0, 0, inf) is not"),
    (text(XYZ, FACES, "0 0 a" + POINTS[5:] + "4 0 1 2 3\n"), 10, "expected a number, got 'a'"),
    (text(XYZ[:-17], FACES, "0 0\n" * 4 + "4 0 1 2 3\n"), 0, "expected an element vertex with the"),
    (text(XYZ, FACES.replace("int ", "float "), POINTS + "4 0 1 2 3\n"), 0, "of whole numbers"),
    (text(XYZ, FACES.replace("vertex_", ""), POINTS + "4 0 1 2 3\n"), 0, "with a list vertex_ind"),
    (text(XYZ, "property int vertex_index\n", POINTS + "4\n"), 0, "with a list vertex_indices of"),
    (ply(SQUARE, [range(4)], "<")[:-1], 0, "the header says 1 faces, 0 are there"),
    (ply(SQUARE, [range(4)] * 3, ">")[:-20], 0, "the header says 3 faces, 1 are there"),
    (ply(SQUARE, [range(4), range(3)], "<")[:-1], 0, "the header says 2 faces, 1 are there"),
    (ply(SQUARE, [], "<")[:-1], 0, "the header says 4 vertices, 3 are there"),
    (ply(SQUARE, [range(4)], "<") + b"\1", 0, "after the last row that the header says there is"),
    (ply(SQUARE, [(0, 1, 2), (0, 1, 9)], ">"), 0, "face 2 names vertex 9, expected 0 to 3"),
    (ply([(0, 0, np.nan), *SQUARE[1:]], [range(4)], ">"), 0, "vertex 1 (0, 0, nan) is not a fin"),
]


@pytest.mark.parametrize(("content", "line", "problem"), REFUSED)
def test_refused(tmp_path: Path, content: bytes, line: int, problem: str) -> None:
    with np.errstate(all="raise"), pytest.raises(SceneError) as caught:
        read(tmp_path, "a.ply", content)
    place = f"{tmp_path}/a.ply:{line}: " if line else f"{tmp_path}/a.ply: "
    assert str(caught.value).startswith(f"{place}not a readable ply mesh: ")
    assert problem in str(caught.value)


def test_blank_bytes_may_follow(tmp_path: Path) -> None:
    assert facts(read(tmp_path, "a.ply", ply(SQUARE, [range(4)], "<") + b"\n\0")) == (2, 1)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("size", [3, 4])
def test_rows_that_are_alike_are_read_as_each_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, order: str, size: int
) -> None:
    rng = np.random.default_rng(size)
    vertices = rng.integers(-9, 9, (40, 3)) / 8
    content = ply(vertices.tolist(), rng.integers(0, 40, (60, size)).tolist(), order)
    together = corners_of(read(tmp_path, "a.ply", content))

    def walked(body, element, begin, source):
        return ply_body._walked(body, element, begin, element.n_rows, source)

    monkeypatch.setattr(ply_body, "_places", walked)
    np.testing.assert_array_equal(corners_of(read(tmp_path, "a.ply", content)), together)
