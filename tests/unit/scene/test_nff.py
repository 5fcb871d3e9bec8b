"""Reading and writing NFF: grammar, round trips, and every way to be wrong."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simmpp.common.errors import SceneError
from simmpp.scene import nff_objects
from simmpp.scene.nff import read_nff, write_nff
from simmpp.scene.nff_words import Words
from simmpp.scene.scene import (
    Camera,
    Cone,
    Light,
    Material,
    MeshPart,
    Polygon,
    Scene,
    SceneObject,
    Sphere,
)
from simmpp.scene.spd.generators import nff

GOLDEN = sorted((Path(__file__).parents[2] / "golden" / "spd").glob("*.nff"))
VIEW = "v from 0 0 5 at 0 0 0 up 0 1 0 angle 45\n"
BALL = "s 0 0 0 1\n"


def read(text: str) -> Scene:
    return read_nff(text, name="test", where="test.nff")


def only(text: str) -> SceneObject:
    (item,) = read(VIEW + text).objects
    return item


@pytest.mark.parametrize("file", GOLDEN, ids=lambda file: file.stem)
def test_spd_texts_survive_reading_and_writing(file: Path) -> None:
    """Compared byte for byte: the SPD's spelling is the one that is written."""
    text = file.read_text()
    assert write_nff(read(text)) == text


@pytest.mark.parametrize("name", ["gears", "lattice", "jacks", "balls"])
def test_larger_spd_texts_survive_too(name: str) -> None:
    text = nff(name, 3)
    assert write_nff(read(text)) == text


def test_every_keyword() -> None:
    scene = read(
        """
        b 0.1 0.2 0.3   # background first, as SPD 3.x
        v from 1 2 3 at 0 0 0 up 0 0 1 angle 30 hither 0.5 resolution 64 32
        l 1 2 3
        l 4 5 6 0.5 0.5 0.25
        f 1 0.5 0 0.7 0.2 10 0.5 1.5
        s 0 0 0 2
        c 0 0 0 1
          0 0 1 0
        f 1 1 1 1 0 1 0 0
        p 4  0 0 0  1 0 0  1 1 0  0 1 0
        pp 3  0 0 0 0 0 1  1 0 0 0 0 1  0 1 0 0 1 1
        f 1 0.5 0 0.7 0.2 10 0.5 1.5
        s 1 1 1 -1e-2
        """
    )
    assert scene.background == (0.1, 0.2, 0.3)
    assert scene.camera == Camera((1, 2, 3), (0, 0, 0), (0, 0, 1), 30, 0.5, (64, 32))
    assert scene.lights == (Light((1, 2, 3)), Light((4, 5, 6), (0.5, 0.5, 0.25)))
    assert scene.materials == (
        Material((1, 0.5, 0), 0.7, 0.2, 10, 0.5, 1.5),
        Material((1, 1, 1), 1, 0, 1, 0, 0),
    )
    sphere, cone, quad, patch, inside = scene.objects
    assert isinstance(sphere, Sphere) and sphere.radius == 2
    assert isinstance(cone, Cone) and (cone.base_radius, cone.apex_radius) == (1, 0)
    assert isinstance(quad, Polygon) and quad.vertices.shape == (4, 3) and quad.normals is None
    assert isinstance(patch, Polygon) and patch.normals is not None
    np.testing.assert_array_equal(patch.vertices[1], (1, 0, 0))
    np.testing.assert_array_equal(patch.normals[2], (0, 1, 1))
    assert isinstance(inside, Sphere) and inside.radius == 0.01
    assert [item.material for item in scene.objects] == [0, 0, 1, 1, 0]


def test_what_may_be_left_out() -> None:
    scene = read(BALL + VIEW)
    assert scene.background == (0, 0, 0)
    assert scene.lights == ()
    assert scene.materials == (Material(),)
    assert scene.camera.hither == 0 and scene.camera.resolution == (512, 512)


def test_line_breaks_and_comments_carry_no_meaning() -> None:
    text = nff("rings", 1)
    words = "\r\n".join(f"{word} # \xe9 nan _" for word in text.split())
    assert write_nff(read(words)) == text


def test_degenerate_polygons_are_kept() -> None:
    item = only("p 3 1 1 1 1 1 1 1 1 1")
    assert isinstance(item, Polygon) and len(item.vertices) == 3


def test_meshes_are_written_as_triangles() -> None:
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=np.float64)
    part = MeshPart(vertices, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32))
    camera = Camera((0, 0, 5), (0, 0, 0), (0, 1, 0))
    again = read(write_nff(Scene("m", (part,), (Material(),), (), camera)))
    triangles = [item.vertices for item in again.objects if isinstance(item, Polygon)]
    np.testing.assert_array_equal(triangles, vertices[part.faces])


def test_coloured_lights_and_patches_survive() -> None:
    text = VIEW + "l 1 2 3 1 0.5 0\nf 1 1 1 1 0 1 0 1\npp 3 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 1 1\n"
    once = write_nff(read(text))
    assert "l 1 2 3 1 0.5 0\n" in once and "0 1 0 0 1 1\n" in once
    assert write_nff(read(once)) == once


WRONG = [
    ("s 0 0 0 abc", 2, "expected a number for the radius of a sphere, got 'abc'"),
    ("s 0 0", 2, "expected a number for the centre of a sphere, but the file ends"),
    ("s 0 0 0\ns 1", 3, "expected a number for the radius of a sphere, got 's'"),
    ("s 0 0 0 nan", 2, "expected a finite number of at most 1e"),
    ("s 0 nan 0 1", 2, "got 'nan'"),
    ("s 0 -inf 0 1", 2, "expected a finite number of at most 1e"),
    ("s 0 0 1e999 1", 2, "got '1e999'"),
    ("s 0 0 0 0", 2, "a sphere needs a radius other than 0"),
    ("s 1_0 0 0 1", 2, "unexpected character '_'"),
    ("s \u0661 0 0 1", 2, "unexpected character"),
    ("\x00\x01", 2, "not an NFF text"),
    ("q 1 2 3", 2, "expected a keyword (v, b, l, f, s, c, p, pp), got 'q'"),
    ("s 0 0 0 1 7", 2, "got '7'"),
    ("c 0 0 0 1 0 0 0 1", 2, "a cone needs a length"),
    ("c 0 0 0 0 0 0 1 0", 2, "a cone needs a radius"),
    ("c 0 0 0 1 0 0 1 -1", 2, "must have the same sign"),
    ("p 2 0 0 0 1 1 1", 2, "the number of vertices of a polygon must be from 3 to"),
    ("p -3", 2, "must be from 3 to"),
    ("p 3.0 0 0 0", 2, "expected a whole number for the number of vertices of a polygon"),
    ("p 999999999 0 0 0", 2, "must be from 3 to 1000000"),
    ("p 9999 0 0 0", 2, "expected a number for a vertex of a polygon, but the file ends"),
    ("p", 2, "expected a whole number for the number of vertices of a polygon, but the file"),
    ("pp 3 0 0 0 0 0 0 1 0 0 0 0 1 0 1 0 0 0 1", 2, "a vertex normal of a patch has no length"),
    ("f 1 1 1 1 0 1 0", 2, "index of refraction of a surface, but the file ends"),
    ("f 1 1 1 -1 0 1 0 0", 2, "must not be negative"),
    ("f 1 -1 1 1 0 1 0 0", 2, "must not be negative"),
    ("f 1 1 1 0 0 1 2 1", 2, "the transmittance must be at most 1"),
    ("f 1 1 1 0 0 1 0.5 0", 2, "needs an index of refraction above 0"),
    ("b 0 0 0\n\nb 0 0 0", 4, "a second background"),
    ("l 1 2 3 4", 2, "expected a number for the colour of a light"),
    ("\n" + VIEW, 3, "a second view"),
]


@pytest.mark.parametrize(("text", "line", "problem"), WRONG, ids=lambda value: str(value)[:30])
def test_wrong_texts_are_refused_with_their_line(text: str, line: int, problem: str) -> None:
    with pytest.raises(SceneError) as caught:
        read(VIEW + text)
    assert str(caught.value).startswith(f"test.nff:{line}: ")
    assert problem in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "no view"),
        (BALL, "no view"),
        ("v at 0 0 0", "expected 'from', got 'at'"),
        ("v from 0 0 5 at 0 0 0 up 0 1 0 hither 1", "expected 'angle', got 'hither'"),
        ("v from 0 0 5 at 0 0 0 up 0 1 0 angle 180", "between 0 and 180"),
        ("v from 0 0 5 at 0 0 5 up 0 1 0 angle 45", "the view needs a direction"),
        ("v from 0 0 5 at 0 0 0 up 0 0 1 angle 45", "the view needs a direction"),
        ("v from 0 0 5 at 0 0 0 up 0 0 0 angle 45", "the view needs a direction"),
        ("v from 0 0 5 at 0 0 0 up 0 1 0 angle 45 hither -1", "must not be negative"),
        ("v from 0 0 5 at 0 0 0 up 0 1 0 angle 45 resolution 0 9", "the resolution must be"),
        ("v from 0 0 5 at 0 0 0 up 0 1 0 angle 45 resolution 9", "the resolution, but the file"),
    ],
)
def test_wrong_views_are_refused(text: str, problem: str) -> None:
    with pytest.raises(SceneError, match="test.nff:1: .*" + problem):
        read(text)


NUMBERS = st.one_of(
    st.floats(width=32).map(str), st.integers(-3, 9).map(str), st.just("1e31"), st.just("0")
)
KEYWORDS = ["b", "v", "l", "f", "s", "c", "p", "pp", "from", "at", "up", "angle", "hither"]
WORDS = st.one_of(st.sampled_from([*KEYWORDS, "#", "\x00", "\n"]), NUMBERS, st.text(max_size=4))
ARGUMENTS = [("s", 4), ("c", 8), ("l", 3), ("l", 6), ("f", 8), ("p 3", 9), ("pp 3", 18), ("b", 3)]


def line(keyword: str, count: int) -> st.SearchStrategy[str]:
    """A line that lacks nothing, though its numbers may make no sense."""
    numbers = st.lists(NUMBERS, min_size=count, max_size=count)
    return numbers.map(lambda values: f"{keyword} {' '.join(values)}")


LINES = st.one_of(
    st.sampled_from([VIEW, BALL]),
    st.sampled_from(ARGUMENTS).flatmap(lambda arguments: line(*arguments)),
    st.lists(WORDS, max_size=4).map(" ".join),
)


@settings(deadline=None)
@given(st.lists(LINES).map("\n".join))
def test_any_text_is_a_scene_or_a_scene_error(text: str) -> None:
    try:
        scene = read(text)
    except SceneError as error:
        assert error.line is not None
        assert "\n" not in str(error)
    else:
        assert scene.camera is not None
        assert write_nff(scene)


REALS = st.floats(-1e30, 1e30)
POSITIVE = st.floats(1e-300, 1e30)
SHARES = st.floats(0, 1e30)
POINTS = st.tuples(REALS, REALS, REALS)
COLOURS = st.tuples(SHARES, SHARES, SHARES)
INDICES = st.integers(0, 2)
MATERIALS = st.builds(
    Material, COLOURS, SHARES, SHARES, SHARES, st.floats(0, 1), st.floats(1e-300, 1e30)
)


def rows(points: st.SearchStrategy[tuple[float, ...]]) -> st.SearchStrategy[np.ndarray]:
    return st.lists(points, min_size=3, max_size=6).map(lambda found: np.array(found, np.float64))


def part(vertices: np.ndarray, faces: list[tuple[int, int, int]], material: int) -> MeshPart:
    return MeshPart(vertices, np.array(faces, dtype=np.int32), material, "part")


SIDES = st.tuples(REALS, st.floats(-1e30, -1) | st.floats(1, 1e30), REALS)
PATCHES = rows(st.tuples(REALS, REALS, REALS, REALS, st.floats(1, 9), REALS)).flatmap(
    lambda found: st.builds(Polygon, st.just(found[:, :3]), st.just(found[:, 3:]), INDICES)
)
OBJECTS = st.one_of(
    st.builds(Sphere, POINTS, POSITIVE, INDICES),
    st.builds(Cone, POINTS, POSITIVE, POINTS, SHARES, INDICES).filter(lambda c: c.base != c.apex),
    st.builds(Polygon, rows(POINTS), st.none(), INDICES),
    PATCHES,
    st.builds(part, rows(POINTS), st.lists(st.tuples(*[INDICES] * 3), min_size=1), INDICES),
)
CAMERAS = st.builds(
    Camera,
    POINTS,
    POINTS,
    st.tuples(st.just(0.0), st.just(0.0), st.just(1.0)),
    st.floats(0.1, 179),
    SHARES,
    st.tuples(st.integers(1, 65536), st.integers(1, 65536)),
).filter(lambda c: abs(c.eye[0] - c.at[0]) > 1e-3 * abs(c.eye[2] - c.at[2]) > 0)
SCENES = st.builds(
    Scene,
    st.just("any"),
    st.lists(OBJECTS).map(tuple),
    st.tuples(*[MATERIALS] * 3),
    st.lists(st.builds(Light, POINTS, COLOURS)).map(tuple),
    CAMERAS,
    COLOURS,
)


def geometry(scene: Scene) -> list[tuple[object, ...]]:
    """Objects with all their numbers and their surface; meshes triangle by triangle."""
    found: list[tuple[object, ...]] = []
    for obj in scene.objects:
        material = scene.materials[obj.material]
        if isinstance(obj, MeshPart):
            found += [
                ("polygon", corners, None, material) for corners in obj.vertices[obj.faces].tolist()
            ]
        elif isinstance(obj, Polygon):
            normals = None if obj.normals is None else obj.normals.tolist()
            found.append(("polygon", obj.vertices.tolist(), normals, material))
        elif isinstance(obj, Sphere):
            found.append(("sphere", obj.centre, obj.radius, material))
        else:
            found.append(("cone", obj.base, obj.base_radius, obj.apex, obj.apex_radius, material))
    return found


@settings(deadline=None)
@given(SCENES)
def test_any_scene_reads_back_as_it_was(scene: Scene) -> None:
    again = read(write_nff(scene))
    assert geometry(again) == geometry(scene)
    assert (again.camera, again.lights) == (scene.camera, scene.lights)
    assert again.background == scene.background


def test_numbers_have_no_more_digits_than_they_need() -> None:
    text = VIEW + "s 0.1 100000.25 1e-07 123456789\nl 1 -2 0.333\n"
    written = write_nff(read(text)).splitlines()
    assert written[-1] == "s 0.1 100000.25 1e-07 123456789" and "l 1 -2 0.333" in written


@pytest.mark.parametrize("number", [1.5e30, float("inf"), float("nan")])
def test_what_nff_does_not_hold_is_not_written(number: float) -> None:
    sphere = Sphere((0, number, 0), 1)
    scene = Scene("s", (sphere,), (Material(),), (), Camera((0, 0, 5), (0, 0, 0), (0, 1, 0)))
    with pytest.raises(SceneError) as caught:
        write_nff(scene)
    assert str(caught.value) == f"the scene has the number {number:g}, NFF's are at most 1e+30"


@pytest.mark.parametrize("size", [1e-300, 1e-160, 1.0, 1e29])
def test_a_view_may_be_of_any_size(size: float) -> None:
    camera = Camera((0, 0, size), (0, 0, 0), (0, size, 0))
    assert read(write_nff(Scene("s", (), (), (), camera))).camera == camera


def test_a_scene_may_be_empty() -> None:
    assert read_nff(VIEW, name="empty", where="empty.nff").objects == ()


SPELLED = st.sampled_from(["0", "1", "-1", "2.5", "1e3", "3", "4", "nan", "1e31", "x", "s", "p"])
HEADS = st.sampled_from([("s", 4), ("c", 8), ("p 3", 9), ("p 4", 12), ("pp 3", 18), ("f", 8)])


@st.composite
def runs_of_objects(draw: Any) -> str:
    """Runs of objects that are spelled alike, most of them right."""
    words = ["v from 9 9 9 at 0 0 0 up 0 0 1 angle 45"]
    for head, n in draw(st.lists(HEADS, max_size=4)):
        for k in range(draw(st.integers(1, 5))):
            words += [head, *(f"{(i * 7 + k) % 11 / 8 + 0.125}" for i in range(n))]
    text = " ".join(words).split(" ")
    for at in draw(st.lists(st.integers(0, len(text) - 1), max_size=2)):
        text[at] = draw(SPELLED)
    return "\n".join(text)


def outcome(text: str) -> tuple[str, str]:
    try:
        scene = read_nff(text, name="a", where="a.nff")
    except SceneError as error:
        return "refused", str(error)
    return "read", write_nff(scene)


@given(runs_of_objects())
def test_runs_are_read_as_their_objects_are_one_by_one(text: str) -> None:
    together = outcome(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(nff_objects, "_count", lambda *_: 0)
        assert outcome(text) == together


def test_what_stands_before_a_mistake_is_read_together() -> None:
    words = Words("s 0 0 0 1\n" * 100 + "s 0 0 0 ?", "a.nff")
    words.position = 1
    assert len(nff_objects._alike(words, ["s"], 4)) == 50


def test_a_mistake_late_in_a_long_run_is_found_at_its_line() -> None:
    text = "v from 9 9 9 at 0 0 0 up 0 0 1 angle 45\n" + "s 0 0 0 1\n" * 5000
    bad = text.replace("s 0 0 0 1\n", "s 0 0 0 ?\n", 1)
    assert outcome(text[: len(text) - 2] + "?")[1].startswith("a.nff:5001:")
    assert outcome(bad)[1].startswith("a.nff:2:")
