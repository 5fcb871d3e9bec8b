"""OBJ: every way to write it that programs have, with what is in it worked out by hand."""

from pathlib import Path

import numpy as np
import pytest
from mesh_files import SQUARE, U, area, corners_of, facts, lines, obj, read

from simmpp.common.errors import SceneError
from simmpp.scene.scene import Material

V = lines([("v", *vertex) for vertex in SQUARE])
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
CURVE = "cstype bspline\ndeg 3\n"

READ = {
    "plain": (V + "f 1 2 3\nf 1 3 4\n", 2, 1),
    "no line end": (V + "f 1 2 3\nf 1 3 4", 2, 1),
    "tabs and indents": ("\tv\t0\t0\t0\n  v 1 0 0\nv  0   1  0\n\tf\t1\t2\t3\n", 1, 0.5),
    "tab after v": ("v 0 0 0\nv\t1\t0\t0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\nf 1 3 4\n", 2, 1),
    "indented face": (V + "f 1 2 3\n  f 1 3 4\n", 2, 1),
    "byte order mark": ("\ufeff" + V + "v 7 7 7\nf 1 2 3\nf 1 3 4\n", 2, 1),
    "mark and CRLF": (("\ufeff" + TRIANGLE + "f 1 2 3").replace("\n", "\r\n"), 1, 0.5),
    "CR alone": ((V + "f 1 2 3 4\n").replace("\n", "\r"), 2, 1),
    "quad": (V + "f 1 2 3 4\n", 2, 1),
    "concave polygon": (obj(U, [range(8)]).decode(), 6, 7),
    "concave quad": ("v 0 0 0\nv 1 3 0\nv 0 1 0\nv -1 3 0\nf 2 3 4 1\n", 2, 1),
    "texture and normal": (V + "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1//1 3//1 4//1\n", 2, 1),
    "slashes of all kinds": (V + "vt 0 0\nvn 0 0 1\nf 1 2/1 3//1 4/1/1\n", 2, 1),
    "slash at the end": (V + "f 1// 2// 3// 4//\n", 2, 1),
    "continued": (V + "f 1 2 \\\n 3 \\\n 4\n", 2, 1),
    "continued, CRLF": ((V + "f 1 2 \\\n 3 4\n").replace("\n", "\r\n"), 2, 1),
    "comment that ends in a backslash": ("# C:\\\n" + V + "f 1 2 3 4\n", 2, 1),
    "comments": ("#v 1 1 1\n" + V + "f 1 2 3 4 # f 1 2 3\n  # f 1 2 3\n", 2, 1),
    "from the last one back": (V + "f -4 -3 -2 -1\n", 2, 1),
    "signs, points, exponents": ("v +0 -0. .0\nv 1e0 0 0\nv 0 1.0E+00 0\nf +1 2 03\n", 1, 0.5),
    "vertices after faces": ("f 1 2 3\n" + TRIANGLE, 1, 0.5),
    "weights": ("v 0 0 0 1\nv 1 0 0 2\nv 0 1 0 1\nf 1 2 3\n", 1, 0.5),
    "lines and points": (TRIANGLE + "l 1 2\np 1 2\nf 1 2 3\n", 1, 0.5),
    "settings": (TRIANGLE + "s off\ng a b\nlod 1\nbevel on\nusemap off\nvp 1\nf 1 2 3\n", 1, 0.5),
    "of version 2": (TRIANGLE + "fo 1 2 3\n", 1, 0.5),
    "an index twice": (TRIANGLE + "f 1 1 2\nf 1 2 3\n", 2, 0.5),
    "unused and not finite": ("v nan 0 0\n" + TRIANGLE + "f 2 3 4\n", 1, 0.5),
    "UTF-16": ((TRIANGLE + "f 1 2 3\n").encode("utf-16"), 1, 0.5),
    "Latin-1": (b"# Gr\xf6\xdfe\n" + TRIANGLE.encode() + b"f 1 2 3\n", 1, 0.5),
}


@pytest.mark.parametrize("name", READ)
def test_read(tmp_path: Path, name: str) -> None:
    text, n, of_area = READ[name]
    content = text if isinstance(text, bytes) else text.encode()
    assert facts(read(tmp_path, "a.obj", content)) == (n, of_area)


def test_negative_indices_count_from_where_they_stand(tmp_path: Path) -> None:
    text = "".join(f"v 0 0 {z}\nv 1 0 {z}\nv 0 1 {z}\nf -3 -2 -1\n" for z in range(3))
    scene = read(tmp_path, "a.obj", text.encode(), "components")
    assert [part.vertices[:, 2].tolist() for part in scene.objects] == [[z] * 3 for z in range(3)]


REFUSED = [
    (TRIANGLE + "f 0 1 2\n", 4, "a face names vertex 0, expected 1 to 3, or -1 to -3"),
    (TRIANGLE + "f 0 1 2\nv 9 9 9\n", 4, "a face names vertex 0, expected 1 to 4, or -1 to -3"),
    (TRIANGLE + "f 1 2 9\n", 4, "names vertex 9"),
    (TRIANGLE + "f -4 -2 -1\nv 1 1 1\n", 4, "names vertex -4, expected 1 to 4, or -1 to -3"),
    (TRIANGLE + "f 1 2\n", 4, "a face needs three vertices"),
    (TRIANGLE + "f\n", 4, "a face needs three vertices"),
    (TRIANGLE + "f 1 2 x\n", 4, "expected a whole number, got 'x'"),
    (TRIANGLE + "f 1 2 1.5\n", 4, "expected a whole number, got '1.5'"),
    (TRIANGLE + "f 1 2 /3\n", 4, "expected a whole number, got ''"),
    (TRIANGLE + "f 1 2 1_0\n", 4, "expected a whole number, got '1_0'"),
    (TRIANGLE + "f 1 2 99999999999999999999\n", 4, "got '99999999999999999999'"),
    ("v 0 0\n" + TRIANGLE, 1, "a vertex needs x, y and z, got 2"),
    ("v 0 0 1,5\n" + TRIANGLE, 1, "expected a number, got '1,5'"),
    ("v 0 0 1_0\n", 1, "expected a number, got '1_0'"),
    ("v 0 0 0x1p3\n", 1, "expected a number, got '0x1p3'"),
    ("v 0 0 0\n\n\\\n\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", 5, "vertex 2 (1, nan, 0) is not a finite"),
    ("v 1e400 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1, "vertex 1 (inf, 0, 0) is not a finite number"),
    ("v 0 0 1e31\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1, "is not a finite number of at most 1e+30"),
    (TRIANGLE + CURVE + "curv 0 1 1 2 3\nend\n", 6, "'curv': free-form curves and surfaces are"),
    (TRIANGLE + CURVE + "surf 0 1 0 1 1 2 3\n", 6, "'surf': free-form"),
    (TRIANGLE + "bzp 1 2 3\n", 4, "'bzp': free-form"),
    (TRIANGLE + "call more.obj\n", 4, "'call': other files and commands are not read"),
    (TRIANGLE + "face 1 2 3\n", 4, "'face': no statement of OBJ"),
    ("\0\0\0", 1, "no statement of OBJ"),
    (TRIANGLE + "f 1 2 3 \\\n x\n", 4, "got 'x'"),
]


@pytest.mark.parametrize(("text", "line", "problem"), REFUSED)
def test_refused(tmp_path: Path, text: str, line: int, problem: str) -> None:
    with pytest.raises(SceneError) as caught:
        read(tmp_path, "a.obj", text.encode())
    assert str(caught.value).startswith(f"{tmp_path}/a.obj:{line}: not a readable obj mesh: ")
    assert problem in str(caught.value)


# --- names and colours ---


def named(tmp_path: Path, text: str) -> list[tuple[str, tuple[float, ...]]]:
    scene = read(tmp_path, "a.obj", text.encode("latin-1"))
    return [(part.name, scene.materials[part.material].colour) for part in scene.objects]


RED, GREEN, GREY = (1, 0, 0), (0, 1, 0), Material().colour
FACE = "f 1 2 3\n"


def test_objects_and_materials_part_groups_do_not(tmp_path: Path) -> None:
    (tmp_path / "two.mtl").write_text("newmtl red\nKd 1 0 0\nnewmtl green\nkd 0 1 0\n")
    text = "mtllib two.mtl\n" + TRIANGLE + FACE + "o b\nusemtl green\n" + FACE + "g x\n" + FACE
    assert named(tmp_path, text + "usemtl red\n" + FACE + "o a\n" + FACE + "o b\n" + FACE) == [
        ("a.obj", GREY),
        ("a_red", RED),
        ("b_green", GREEN),
        ("b_red", RED),
    ]


def test_one_material_needs_no_name(tmp_path: Path) -> None:
    (tmp_path / "one.mtl").write_text("newmtl red\nKd 1 0 0\n")
    text = "mtllib one.mtl\n" + TRIANGLE + "o a\nusemtl red\n" + FACE + "o\n" + FACE
    assert named(tmp_path, text) == [("a", RED), ("a.obj", RED)]


def test_a_library_of_two_names_both(tmp_path: Path) -> None:
    (tmp_path / "two.mtl").write_text("newmtl red\nKd 1 0 0\nnewmtl green\nKd 0 1 0\n")
    text = "mtllib two.mtl\n" + TRIANGLE + "o a\nusemtl red\n" + FACE
    assert named(tmp_path, text) == [("a_red", RED)]


LIBRARIES = {
    "names with blanks": ("two words.mtl", "two words.mtl"),
    "several files": ("none.mtl m.mtl", "m.mtl"),
    "a folder": (".\\sub\\m.mtl", "sub/m.mtl"),
}


@pytest.mark.parametrize("name", LIBRARIES)
def test_libraries(tmp_path: Path, name: str) -> None:
    said, file = LIBRARIES[name]
    (tmp_path / file).parent.mkdir(exist_ok=True)
    (tmp_path / file).write_text("newmtl a  b\nKd 1 0 0\n")
    text = f"mtllib {said}\n" + TRIANGLE + "usemtl a b\n" + FACE
    assert named(tmp_path, text) == [("a.obj", RED)]


DIFFUSE = {
    "Kd 1": (1, 1, 1),
    "Kd 0.5 0.25 7": (128 / 255, 64 / 255, 1),
    "Kd nan 1 -1": (0, 1, 0),
    "Kd xyz 1 1 1": GREY,
    "Kd 1 0": GREY,
    "": GREY,
    "Ka 1 0 0\nd 0.5\nmap_Kd a.png": GREY,
}


@pytest.mark.parametrize("line", DIFFUSE)
def test_diffuse_colours(tmp_path: Path, line: str) -> None:
    (tmp_path / "m.mtl").write_text(f"Kd 0 0 1\nnewmtl a\n{line}\n")
    text = "mtllib m.mtl\n" + TRIANGLE + "usemtl a\n" + FACE
    assert named(tmp_path, text) == [("a.obj", DIFFUSE[line])]


GLASS = "illum 9\nd 0.25\nNi 1.5\nKs 0.2 0.4 0\nNs 90\n"
KS = 51 / 255  # the mean of 0.2, 0.4 and 0
FINISHES = {
    "Ks 1 1 1\nNs 90": (1, 0, 1, 0, 1),
    "Ks 0.2 0.4 0\nNs 90\nillum 2": (1, 0, 1, 0, 1),
    "Ks 0.2 0.4 0\nNs 90\nillum 3": (1, KS, 90, 0, 1),
    "Ks 0.2 0.4 0\nNs 0\nillum 5\nNi 1.5": (1, KS, 1, 0, 1),
    "Ks 0.2 0.4 0\nNs 90\nillum 8": (1, 0, 1, 0, 1),
    GLASS: (0.25, KS, 90, 0.75, 1.5),
    "d 0.25": (0.25, 0, 1, 0.75, 1),
    "d -halo 0.25": (0.25, 0, 1, 0.75, 1),
    "Tr 0.75\nNi 0": (0.25, 0, 1, 0.75, 1),
    "Tr 1\nd 1\nNi 1.5": (1, 0, 1, 0, 1),
    "d 7\nTr nan": (1, 0, 1, 0, 1),
    "d -7": (0, 0, 1, 1, 1),
    "d glass\nNs none\nillum": (1, 0, 1, 0, 1),
    "Tf 1 1 1\nNi 1.5\nillum 7": (0, 0, 1, 1, 1.5),
    "Tf 1 1 1\nNi 1.5\nillum 4": (1, 0, 1, 0, 1),
}


@pytest.mark.parametrize("lines", FINISHES)
def test_mirrors_and_glass(tmp_path: Path, lines: str) -> None:
    (tmp_path / "m.mtl").write_text(f"newmtl a\n{lines}\nKd 1 0 0 # red\n")
    scene = read(tmp_path, "a.obj", f"mtllib m.mtl\n{TRIANGLE}usemtl a\n{FACE}".encode())
    (found,) = scene.materials
    assert found.colour == RED and scene.origin.notes == ()
    finish = (found.kd, found.ks, found.shine, found.transmittance, found.ior)
    assert finish == pytest.approx(FINISHES[lines], abs=1e-12)


@pytest.mark.parametrize(
    ("line", "emission"),
    [
        ("Ke 15 12.5 7", (15, 12.5, 7)),
        ("Ke 3", (3, 3, 3)),
        ("Ke", (0, 0, 0)),
        ("Ke bright", (0, 0, 0)),
        ("Ke 1 -1 1", (0, 0, 0)),
        ("Ke nan 1 1", (0, 0, 0)),
        ("Ke spectral lamp.rfl 1", (0, 0, 0)),
    ],
)
def test_what_shines(tmp_path: Path, line: str, emission: tuple[float, ...]) -> None:
    (tmp_path / "m.mtl").write_text(f"newmtl a\nKd 1 0 0\n{line}\n")
    scene = read(tmp_path, "a.obj", f"mtllib m.mtl\n{TRIANGLE}usemtl a\n{FACE}".encode())
    assert [material.emission for material in scene.materials] == [emission]


def test_glass_may_have_the_colours_of_vertices(tmp_path: Path) -> None:
    (tmp_path / "m.mtl").write_text(f"newmtl a\n{GLASS}")
    painted = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\n"
    scene = read(tmp_path, "a.obj", f"mtllib m.mtl\n{painted}usemtl a\n{FACE}".encode())
    assert scene.materials[0].colour == RED and scene.materials[0].transmits


NOTES = {
    "mtllib none.mtl": "mtllib 'none.mtl' is left out: can't read the file: No such file or",
    "mtllib none.mtl m.mtl": "mtllib 'none.mtl' is left out: can't read the file: No such file or",
    "mtllib m.mtl\nusemtl other": "material 'other' is in no mtllib that was read: grey",
    "mtllib m.mtl\nusemtl a": "textures of 'a' and 1 more are not read: their colours are the one",
    "mtllib \u7acb.mtl": "mtllib '\u7acb.mtl' is left out: can't read the file",
    "usemtl a": "material 'a' is in no mtllib that was read: grey",
    "mtllib s.mtl": "Kd of 'c' is no colour of one number or three: grey",
}


@pytest.mark.parametrize("lines", NOTES)
def test_what_is_not_read_is_said(tmp_path: Path, lines: str) -> None:
    (tmp_path / "m.mtl").write_text("newmtl a\nmap_Kd a.png\nnewmtl b\nKd 1 1 1\nmap_kd b.png\n")
    (tmp_path / "s.mtl").write_text("newmtl c\nKd spectral c.rfl\n")
    scene = read(tmp_path, "a.obj", f"{lines}\n{TRIANGLE}{FACE}".encode())
    assert any(note.startswith(NOTES[lines]) for note in scene.origin.notes)


@pytest.mark.parametrize("library", ["none.mtl", "x" * 300, "\0", ".", "/dev/zero", "bad.mtl.gz"])
def test_without_its_library_it_is_grey(tmp_path: Path, library: str) -> None:
    (tmp_path / "bad.mtl.gz").write_bytes(b"\x1f\x8b\x00")
    text = f"mtllib {library}\n" + TRIANGLE + "usemtl a\n" + FACE
    assert named(tmp_path, text) == [("a.obj", GREY)]


def test_colours_of_vertices(tmp_path: Path) -> None:
    painted = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 0 0 0\n"
    assert named(tmp_path, painted + "v 9 9 9 0 1 1\n" + FACE) == [("a.obj", (2 / 3, 0, 0))]
    assert named(tmp_path, painted + "v 9 9 9\n" + FACE) == [("a.obj", GREY)], "not all have one"


def test_names_are_utf_8_or_latin_1(tmp_path: Path) -> None:
    for encoding in ("utf-8", "latin-1"):
        text = TRIANGLE.encode() + "o Würfel\n".encode(encoding) + FACE.encode()
        (part,) = read(tmp_path, "a.obj", text).objects
        assert part.name == "Würfel"


def test_a_file_name_of_any_bytes(tmp_path: Path) -> None:
    scene = read(tmp_path, "n\udcfc.obj", obj(SQUARE, [range(4)]))
    assert facts(scene) == (2, 1)


def test_large_coordinates_keep_all_digits(tmp_path: Path) -> None:
    vertices = [(100000.6, 100000.2, 1), (100000.9, 100000.2, 1), (100000.9, 100000.4, 1)]
    corners = corners_of(read(tmp_path, "a.obj", obj(vertices, [range(3)])))
    np.testing.assert_array_equal(corners, [vertices])
    assert area(corners) == pytest.approx(0.03)
