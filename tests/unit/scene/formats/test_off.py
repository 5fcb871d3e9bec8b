"""OFF: its keywords, counts and comments."""

from pathlib import Path

import pytest
from mesh_files import SQUARE, U, facts, lines, off, read

from simmpp.common.errors import SceneError

V, F = lines(SQUARE), "4 0 1 2 3\n"
PLAIN = f"OFF\n4 1 0\n{V}{F}"
COLOURED = lines([(*vertex, 0, 255, 0, 255) for vertex in SQUARE])
NORMALS = lines([(*vertex, 0, 0, 1) for vertex in SQUARE])
EVERYTHING = lines([(*vertex, 0, 0, 1, 1, 1, 1, 1, 0, 0) for vertex in SQUARE])
READ = {
    "plain": (PLAIN, 2, 1),
    "concave": (off(U, [range(8)]).decode(), 6, 7),
    "no keyword": (f"4 1 0\n{V}{F}", 2, 1),
    "counts beside the keyword": (f"OFF 4 1 0\n{V}{F}", 2, 1),
    "counts at the keyword": (f"OFF4 1 0\n{V}{F}", 2, 1),
    "two counts": (f"OFF\n4 1\n{V}{F}", 2, 1),
    "comments and blank lines": (f"# a\n\n OFF # b\n# c\n4\t1 0 # d\n\n{V}\n# e\n{F} # f\n", 2, 1),
    "colours of faces": (f"OFF\n4 2 0\n{V}4 0 1 2 3 0.5 0.5 0.5\n3 0 1 2 255 0 0 255\n", 3, 1.5),
    "colours of vertices": (f"COFF\n4 1 0\n{COLOURED}{F}", 2, 1),
    "normals": (f"NOFF\n4 1 0\n{NORMALS}{F}", 2, 1),
    "everything": (f"STCNOFF\n4 1 0\n{EVERYTHING}{F}", 2, 1),
    "lines and points": (f"OFF\n4 4 0\n{V}{F}2 0 1\n1 3\n0\n", 2, 1),
    "CRLF": (PLAIN.replace("\n", "\r\n"), 2, 1),
    "byte order mark": ("\ufeff" + PLAIN, 2, 1),
}


@pytest.mark.parametrize("name", READ)
def test_read(tmp_path: Path, name: str) -> None:
    text, n, of_area = READ[name]
    assert facts(read(tmp_path, "a.off", text.encode())) == (n, of_area)


REFUSED = [
    ("", 0, "expected OFF and the numbers of vertices and faces, got nothing"),
    ("hello", 0, "expected OFF and the numbers of vertices and faces, got 'hello'"),
    ("OFF", 0, "expected OFF and the numbers of vertices and faces, got nothing"),
    ("OFF BINARY\n\0\0", 0, "binary OFF is not read"),
    (f"4OFF\n4 1 0\n{V}{F}", 0, "4OFF has points of other than three dimensions"),
    (f"nOFF\n3\n4 1 0\n{V}{F}", 0, "nOFF has points of other than three dimensions"),
    (f"OFF\n4\n{V}{F}", 2, "expected the numbers of vertices and faces"),
    (f"OFF\n-4 1 0\n{V}{F}", 2, "expected the numbers of vertices and faces"),
    (f"OFF\n4 x 0\n{V}{F}", 2, "expected a whole number, got 'x'"),
    (f"OFF\n4 3 0\n{V}{F}{F}", 0, "the header says 3 faces, 2 are there"),
    ("OFF\n4 3 0\n0 0 0\n", 0, "the header says 4 vertices, 1 are there"),
    ("OFF\n999999999999999999 3 0\n", 0, "the header says 999999999999999999 vertices, 0 are"),
    (PLAIN + F, 8, "the header says 4 vertices and 1 faces, here is more"),
    (PLAIN.replace("1 1 0\n", "1 1\n"), 5, "a vertex needs x, y and z"),
    (PLAIN.replace("1 1 0\n", "1 1 a\n"), 5, "expected a number, got 'a'"),
    (PLAIN.replace("1 1 0\n", "1 1 nan\n"), 5, "vertex 3 (1, 1, nan) is not a finite number"),
    (PLAIN.replace("4 0 1 2 3", "4 0 1 2"), 7, "a face of 4 vertices has 3"),
    (PLAIN.replace("4 0 1 2 3", "-1 0 1 2"), 7, "a face of -1 vertices has 3"),
    (PLAIN.replace("4 0 1 2 3", "4 0 1 2 4"), 7, "face 1 names vertex 4, expected 0 to 3"),
    (PLAIN.replace("4 0 1 2 3", "4 0 1 2 -1"), 7, "face 1 names vertex -1, expected 0 to 3"),
    (PLAIN.replace("4 0 1 2 3", "4 0 1 2 x"), 7, "expected a whole number, got 'x'"),
    (PLAIN.replace("4 0 1 2 3", "x 0 1 2 3"), 7, "expected a whole number, got 'x'"),
]


@pytest.mark.parametrize(("text", "line", "problem"), REFUSED)
def test_refused(tmp_path: Path, text: str, line: int, problem: str) -> None:
    with pytest.raises(SceneError) as caught:
        read(tmp_path, "a.off", text.encode())
    place = f"{tmp_path}/a.off:{line}: " if line else f"{tmp_path}/a.off: "
    assert str(caught.value).startswith(f"{place}not a readable off mesh: ")
    assert problem in str(caught.value)
