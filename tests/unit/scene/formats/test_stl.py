"""STL: text and binary, and the lengths that binary headers say."""

from pathlib import Path

import numpy as np
import pytest
from mesh_files import corners_of, facts, read, stl, stl_text

from simmpp.common.errors import SceneError

TWO = np.array([[(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 0, 2), (1, 0, 2), (0, 1, 2)]], dtype=float)
FACET = stl_text(TWO[:1]).decode().partition("\n")[2].rpartition("endsolid")[0]
ODD = FACET.replace("0 0 0", "-nan(ind) x 0", 1)
LINE = FACET.replace("\n", " ")

READ = {
    "text": (stl_text(TWO), 2),
    "capitals": (stl_text(TWO).upper(), 2),
    "CRLF": (stl_text(TWO).replace(b"\n", b"\r\n"), 2),
    "tabs": (stl_text(TWO).replace(b" ", b"\t"), 2),
    "byte order mark": (b"\xef\xbb\xbf" + stl_text(TWO), 2),
    "Latin-1": (stl_text(TWO, "Größe").decode().encode("latin-1"), 2),
    "no line ends within a solid": (f"solid\n{LINE * 3}endsolid".encode(), 3),
    "no name": (f"solid\n{FACET}endsolid\n".encode(), 1),
    "a name that ends it": (f"solid a\n{FACET}endsolid b c\n\n \n".encode(), 1),
    "a name of its words": (f"solid facet outer endsolid\n{FACET}endsolid\n".encode(), 1),
    "no normal": (f"solid\n{FACET.replace(' normal 0 0 0', '')}endsolid".encode(), 1),
    "normals that are no numbers": (f"solid\n{ODD}endsolid".encode(), 1),
    "an empty solid before": (b"solid a\nendsolid a\n" + stl_text(TWO), 2),
    "binary": (stl(TWO), 2),
    "binary that begins with solid": (stl(TWO, b"solid x\nfacet"), 2),
    "binary of solid without a count": (stl(TWO, b"solid x\nfacet", 0), 2),
    "binary without a count": (stl(TWO, count=0), 2),
    "binary and a few bytes more": (stl(TWO) + bytes(7), 2),
}


@pytest.mark.parametrize("name", READ)
def test_read(tmp_path: Path, name: str) -> None:
    content, n = READ[name]
    scene = read(tmp_path, "a.stl", content)
    assert facts(scene) == (n, n / 2)


def test_binary_and_text_hold_the_same(tmp_path: Path) -> None:
    corners = np.random.default_rng(1).normal(size=(50, 3, 3)).astype(np.float32).astype(np.float64)
    for content in (stl(corners), stl_text(corners)):
        np.testing.assert_array_equal(corners_of(read(tmp_path, "a.stl", content)), corners)


def test_each_solid_is_a_node_by_name(tmp_path: Path) -> None:
    content = stl_text(TWO[1:], "b") + stl_text(TWO[:1], "a") + stl_text(TWO, " ")
    scene = read(tmp_path, "c.stl", content)
    found = [(part.name, len(part.faces)) for part in scene.objects]
    assert found == [("a", 1), ("b", 1), ("c.stl", 2)]
    assert scene.camera.up == (0, 0, 1)


WHOLE = stl_text(TWO).decode()
REFUSED = [
    (b"hello there", 0, "expected solid, or a binary header of 84 bytes"),
    (b"", 0, "expected solid, or a binary header of 84 bytes"),
    (stl(TWO, count=3), 0, "the header says 3 triangles, the file holds 2"),
    (stl(TWO, count=1), 0, "the header says 1 triangles, the file holds 2"),
    (stl(TWO)[:-1], 0, "the header says 2 triangles, the file holds 1"),
    (stl(TWO, b"solid", 9), 0, "the header says 9 triangles, the file holds 2"),
    (WHOLE[: WHOLE.rindex("endsolid")], 16, "the file ends after 2 facets of a solid, without an"),
    (WHOLE[: WHOLE.rindex("vertex")], 9, "this facet is cut off, or has not three vertices"),
    (WHOLE.replace("  endloop", "   vertex 1 2 3\n  endloop", 1), 2, "this facet is cut off, or"),
    (WHOLE.replace("   vertex 0.0 1.0 2.0\n", ""), 9, "this facet is cut off, or has not three"),
    (
        WHOLE.replace(" endfacet", " endfacet\n color 1 0 0"),
        9,
        "expected facet or endsolid, got 'c",
    ),
    (WHOLE + "x", 17, "expected solid, got 'x'"),
    (WHOLE + WHOLE[:-20], 25, "this facet is cut off"),
    (WHOLE.replace("1.0 0.0 2.0", "1.0 x 2.0"), 12, "expected a number, got 'x'"),
    (
        WHOLE.replace("1.0 0.0 2.0", "1.0 nan 2.0"),
        12,
        "vertex 5 (1, nan, 2) is not a finite number",
    ),
    (WHOLE.replace("1.0 0.0 2.0", "1.0 1e400 2.0"), 12, "vertex 5 (1, inf, 2) is not a finite num"),
    (stl(TWO * np.nan), 0, "vertex 1 (nan, nan, nan) is not a finite number"),
]


@pytest.mark.parametrize(("content", "line", "problem"), REFUSED)
def test_refused(tmp_path: Path, content: bytes | str, line: int, problem: str) -> None:
    with pytest.raises(SceneError) as caught:
        read(tmp_path, "a.stl", content if isinstance(content, bytes) else content.encode())
    place = f"{tmp_path}/a.stl:{line}: " if line else f"{tmp_path}/a.stl: "
    assert str(caught.value).startswith(f"{place}not a readable stl mesh: ")
    assert problem in str(caught.value)
