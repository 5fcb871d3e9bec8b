"""Any OBJ, PLY, STL or OFF is read, or refused in one line: words, bytes and lines damaged.

An example is a seed: drawing each damage would take most of the time.
"""

# ruff: noqa: SIM905
from __future__ import annotations

import gzip
import warnings
from collections.abc import Callable
from pathlib import Path
from random import Random

import numpy as np
import pytest
from fuzzing import LONGEST_LINE, TRIED, examples
from hypothesis import given
from hypothesis import strategies as st
from mesh_files import SQUARE, U, obj, off, ply, stl, stl_text

from simmpp.common.errors import SceneError
from simmpp.scene.check import check_scene
from simmpp.scene.mesh import READERS, load_mesh
from simmpp.scene.packed import read_whole

SOUP = [*SQUARE, *((x + 5, y, 1) for x, y, _ in U)], [range(4), (0, 1, 2), range(4, 12)]
CORNERS = np.arange(27.0).reshape(3, 3, 3) ** 2
STRIPS = ply(*SOUP).replace(b"element face", b"element tristrips")
FILES = {
    "obj": [
        obj(*SOUP),
        b"o a\nusemtl b\n# c\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nvt 0 0\nvn 0 0 1\n"
        b"f 1/1/1 2//1 \\\n 3/1\ng d\nl 1 2\nf -3 -2 -1\n",
    ],
    "ply": [*(ply(*SOUP, order) for order in ["", "<", ">"]), STRIPS],
    "stl": [stl_text(CORNERS) + stl_text(CORNERS, "b"), stl(CORNERS), stl(CORNERS, b"solid", 0)],
    "off": [off(*SOUP), off(*SOUP).replace(b"OFF\n", b"COFF # c\n")],
}
NUMBERS = (
    "0 1 -1 2 3 9 0.5 nan inf -inf 1e400 1e30 1e31 5e-324 0x10 1_0 1e + - . 1,5 2147483648"
    " 9223372036854775808 -9223372036854775808 99999999999999999999"
).split()
WORDS = {
    "obj": "v f vn vt o g usemtl mtllib fo l p surf curv # \\ / 1/2 1//2 /1 -1/-1 a.mtl é",
    "ply": "ply format ascii binary_little_endian 1.0 element vertex face tristrips property list"
    " uchar int float double int64 x y z red vertex_indices end_header comment",
    "stl": "solid facet normal outer loop vertex endloop endfacet endsolid SOLID",
    "off": "OFF COFF NOFF 4OFF nOFF BINARY #",
}


def words_changed(data: bytes, kind: str, random: Random) -> bytes:
    words = data.decode("latin-1").replace("\n", " \n ").split(" ")
    others = [*WORDS[kind].split(), *NUMBERS, "\n", "", random.choice(words)]
    for _ in range(random.randint(1, 4)):
        at = random.randrange(len(words))
        words[at : at + random.randint(0, 2)] = random.choices(others, k=random.randint(0, 2))
    return " ".join(words).replace(" \n ", "\n").encode("latin-1")


def bytes_changed(data: bytes, _kind: str, random: Random) -> bytes:
    damage = bytearray(data)
    for _ in range(random.randint(1, 4)):
        at = random.randrange(len(damage) + 1)
        put = random.choice([random.randbytes(random.randint(0, 4)), b"\0\0", b"\xff\xff\xff\xff"])
        damage[at : at + random.randint(0, 4)] = put
    return bytes(damage)


def cut_off(data: bytes, _kind: str, random: Random) -> bytes:
    return data[: random.randrange(len(data))]


def lines_moved(data: bytes, _kind: str, random: Random) -> bytes:
    lines = data.split(b"\n")
    lines.insert(random.randrange(len(lines)), lines.pop(random.randrange(len(lines))))
    return b"\n".join(lines)


WAYS: list[Callable[[bytes, str, Random], bytes]] = [
    words_changed,
    words_changed,
    bytes_changed,
    bytes_changed,
    cut_off,
    lines_moved,
]


def read_or_refused(kind: str, content: bytes) -> None:
    """Bytes to the reader itself: opening files would take most of the time."""
    with warnings.catch_warnings(), np.errstate(over="ignore", invalid="ignore"):  # as load_mesh
        warnings.simplefilter("error")
        try:
            nodes = READERS[kind](content, Path(f"a.{kind}")).nodes
        except SceneError as error:
            TRIED[f"{kind}: refused"] += 1
            message = str(error)
            assert message.startswith(f"a.{kind}:") and len(message) < LONGEST_LINE, message
            assert message.isprintable(), message
        else:
            TRIED[f"{kind}: read"] += 1
            for node in nodes:
                assert (
                    np.isfinite(node.vertices[node.faces]).all() and node.faces.min(initial=0) >= 0
                )


@pytest.mark.parametrize("kind", FILES)
def test_damaged(kind: str) -> None:
    @examples(5000)
    @given(st.integers(0, 2**32))
    def any_damage(seed: int) -> None:
        random = Random(seed)
        read_or_refused(kind, random.choice(WAYS)(random.choice(FILES[kind]), kind, random))

    any_damage()


MTL = (
    b"newmtl a\nKd 1 0.5 0\nKs 0.2 0.2 0.2\nNs 90\nd 0.5\nNi 1.5\nillum 7\nTf 1 1 1\n"
    b"newmtl b # c\nKd 1\nTr 0.25\nmap_Kd b.png\n"
)
WORDS["mtl"] = "newmtl Kd Ks Ns d Tr Ni illum Tf map_Kd spectral xyz -halo # \\ a é"


@examples(300)
@given(st.integers(0, 2**32))
def test_a_damaged_library_is_read(seed: int) -> None:
    random = Random(seed)
    Path("a.mtl").write_bytes(random.choice(WAYS)(MTL, "mtl", random))
    Path("a.obj").write_bytes(b"mtllib a.mtl\nusemtl a\n" + obj(*SOUP) + b"usemtl b\nf 1 2 3\n")
    scene = load_mesh("a.obj")
    check_scene(scene)
    assert all(note.isprintable() for note in scene.origin.notes)


@examples(200)
@given(st.integers(0, 2**32))
def test_damaged_packages(seed: int) -> None:
    random = Random(seed)
    kind = random.choice(list(FILES))
    content = gzip.compress(random.choice(FILES[kind]), mtime=0)
    file = Path(f"a.{kind}.gz")
    file.write_bytes(random.choice([bytes_changed, cut_off])(content, kind, random))
    try:
        unpacked = read_whole(file)
    except SceneError as error:
        TRIED["gz: refused"] += 1
        assert str(error).startswith("a.") and str(error).isprintable()
    else:
        read_or_refused(kind, unpacked)
