"""Camera, lights and parts as users set them, over what files say."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import File, one_square

from simmpp.common.errors import InputError
from simmpp.config.config import config_from_mapping, load_config
from simmpp.scene.parts import PartSettings
from simmpp.scene.scene import MeshPart, Scene
from simmpp.workload.sources import load_scene

TETRAHEDRON = """o a
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
g base
f 1 3 2
g sides
f 1 2 4
f 1 4 3
f 2 3 4
"""
NFF = "v from 1 2 3 at 0 0 0 up 0 0 1 angle 40 hither 1 resolution 64 32 l 1 1 9 s 0 0 0 1\n"
HALF = 0.5**0.5


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.obj").write_text(TETRAHEDRON)
    Path("own.nff").write_text(NFF)
    file = one_square()
    file.add("cameras", type="perspective", perspective={"yfov": np.pi / 3})
    file.add("cameras", type="orthographic", orthographic={"xmag": 1, "ymag": 1})
    file.node(name="Front", camera=0, translation=[1, 2, 9])
    file.node(name="Down", camera=0, rotation=[-HALF, 0, 0, HALF], translation=[0, 50, 0])
    file.node(name="Flat", camera=1)
    file.write(Path("seen.glb"))


def seen(**scene: Any) -> Scene:
    return load_scene({"mesh": "a.obj", **scene})


def refusal(**scene: Any) -> str:
    with pytest.raises(InputError) as caught:
        load_scene(scene)
    message = str(caught.value)
    assert message.isprintable() and len(message) < 300
    return message


def test_without_any_it_is_as_it_was() -> None:
    plain = seen()
    assert plain.camera.up == (0, 1, 0) and plain.camera.angle_degrees == 45
    assert (
        plain.origin.view
        == "seen by a camera that sees everything, y up, lit by 2 lights around it all"
    )
    assert seen(up="z").camera.up == (0, 0, 1)
    assert seen(up="z").camera.eye != plain.camera.eye
    assert seen(up="z").origin.camera == "a camera that sees everything, z up"
    upright = load_scene({"nff": "own.nff", "up": "y"})
    assert upright.camera.up == (0, 1, 0) and upright.origin.camera == "its own camera, y up"
    nff = load_scene("own.nff")
    assert (nff.camera.eye, nff.camera.resolution) == ((1, 2, 3), (64, 32))
    assert nff.origin.view == "seen by its own camera, lit by its own lights"


def test_parts_of_a_camera_leave_the_rest() -> None:
    plain = seen()
    camera = seen(camera={"angle": 20}).camera
    assert (camera.eye, camera.at, camera.angle_degrees) == (plain.camera.eye, plain.camera.at, 20)
    scene = seen(camera={"eye": [0, 0, 5], "at": [0, 1, 0]}, up="z")
    assert (scene.camera.eye, scene.camera.at, scene.camera.up) == ((0, 0, 5), (0, 1, 0), (0, 0, 1))
    assert scene.origin.camera == "a camera as set, z up" and scene.lights == seen(up="z").lights
    nff = load_scene({"nff": "own.nff", "camera": {"eye": [5, 0, 0]}})
    assert (nff.camera.eye, nff.camera.at, nff.camera.up) == ((5, 0, 0), (0, 0, 0), (0, 0, 1))
    assert nff.camera.resolution == (64, 32) and nff.camera.angle_degrees == 40


def test_lights() -> None:
    scene = seen(lights=[{"position": [1, 2, 3]}, {"position": [4, 5, 6], "colour": [1, 0, 0.5]}])
    assert [light.position for light in scene.lights] == [(1, 2, 3), (4, 5, 6)]
    assert [light.colour for light in scene.lights] == [(1, 1, 1), (1, 0, 0.5)]
    assert scene.camera == seen().camera and "2 lights as set" in scene.origin.view
    assert load_scene({"nff": "own.nff", "lights": []}).lights == ()


def test_a_camera_of_the_file_by_name_and_by_number() -> None:
    first = load_scene("seen.glb")
    assert first.origin.camera == "camera 'Front' of the file"
    assert first.camera.eye == (1, 2, 9) and first.camera.angle_degrees == pytest.approx(60)
    assert np.subtract(first.camera.at, first.camera.eye).tolist() == [0, 0, -9]
    for wanted in ("Down", 1, {"name": "Down"}):
        camera = load_scene({"mesh": "seen.glb", "camera": wanted}).camera
        assert camera.eye == (0, 50, 0)
        assert np.subtract(camera.at, camera.eye) == pytest.approx([0, -50, 0])
        assert camera.up == pytest.approx((0, 0, -1))
    wide = load_scene({"mesh": "seen.glb", "camera": {"name": "Down", "angle": 90}})
    assert (wide.camera.eye, wide.camera.angle_degrees) == ((0, 50, 0), 90)
    assert wide.origin.camera == "camera 'Down' of the file, angle as set"
    # Its own up is the way it was held there: from elsewhere, y is upwards.
    moved = load_scene({"mesh": "seen.glb", "camera": {"name": "Down", "eye": [3, 1, 0]}})
    assert moved.camera.up == (0, 1, 0)
    whole = load_scene({"mesh": "seen.glb", "camera": "everything"})
    assert whole.origin.camera == "a camera that sees everything"
    assert whole.camera.angle_degrees == 45 and whole.camera.at == (0.5, 0.5, 0)
    assert first.origin.notes == ("camera 'Flat' is left out: orthographic, not perspective",)


@pytest.mark.parametrize(
    ("key", "value", "problem"),
    [
        (
            "camera",
            {"eye": [1, 2, 3], "at": [1, 2, 3]},
            "scene.camera: eye and at are both [1.0, 2",
        ),
        (
            "camera",
            {"angle": 0},
            "scene.camera.angle: value 0: expected an angle above 0 and below",
        ),
        ("camera", {"angle": 180}, "scene.camera.angle: value 180: expected an angle above 0 and"),
        ("camera", {"angle": True}, "scene.camera.angle: value true: expected an angle"),
        ("camera", {"angle": "wide"}, "scene.camera.angle: value 'wide': expected an angle"),
        ("camera", {"up": [0, 0, 0]}, "scene.camera: up is [0, 0, 0]: expected a direction"),
        (
            "camera",
            {"eye": [0, 5, 0], "at": [0, 1, 0], "up": [0, -2, 0]},
            "scene.camera: up [0.0, -2.0, 0.0] is along the view: expected a direction across it",
        ),
        (
            "camera",
            {"eye": [0, 5, 0], "at": [0, 1, 0]},
            "a.obj:components: scene.camera: eye [0.0, 5.0, 0.0] and at [0.0, 1.0, 0.0] are one "
            "point, or up [0.0, 1.0, 0.0] is along the view",
        ),
        ("camera", {"eye": [0, 5]}, "scene.camera.eye: value [0, 5]: expected three numbers, such"),
        ("camera", {"eye": [0, 5, None]}, "scene.camera.eye: value [0, 5, None]: expected three"),
        ("camera", {"at": [0, 5, float("nan")]}, "scene.camera.at: value [0, 5, nan]: expected"),
        ("camera", {"at": [0, 5, 1e31]}, "scene.camera.at: value [0, 5, 1e+31]: expected three"),
        ("camera", {"fov": 3}, "scene.camera: unknown key 'fov': expected one of angle, at, eye"),
        ("camera", "Top", "a.obj:components: there is no camera 'Top': expected 0 ('everything')"),
        ("camera", -1, "scene.camera.name: value -1: expected the name or number of a camera"),
        ("camera", [0, 1, 2], "scene.camera: value [0, 1, 2]: expected a mapping (key: value)"),
        (
            "lights",
            {"position": [0, 1, 2]},
            "scene.lights: value {'position': [0, 1, 2]}: expected",
        ),
        ("lights", [[0, 1, 2]], "scene.lights[0]: value [0, 1, 2]: expected a mapping"),
        ("lights", [{}], "scene.lights[0]: missing key 'position'"),
        (
            "lights",
            [{"position": [0, 1]}],
            "scene.lights[0].position: value [0, 1]: expected three",
        ),
        (
            "lights",
            [{"position": [0, 1, 2], "colour": [1, 1, -1]}],
            "scene.lights[0].colour: value [1, 1, -1]: expected three numbers from 0, such as",
        ),
        ("up", "x", "scene.up: value 'x': expected y or z"),
        ("objects", "group", "scene.objects: value 'group': expected nodes, components, groups or"),
        (
            "parts",
            [{"mesh": "a.obj"}],
            "scene: expected one of spd, nff, mesh, parts, cells, workload, got",
        ),
    ],
)
def test_wrong_views(key: str, value: object, problem: str) -> None:
    assert refusal(mesh="a.obj", **{key: value}).startswith(problem)


@pytest.mark.parametrize(
    ("part", "problem"),
    [
        ({"mesh": "b.obj"}, "b.obj: can't read the file: No such file or directory"),
        ({}, "scene.parts[1]: missing key 'mesh'"),
        (
            {"mesh": "a.obj", "scale": 0},
            "scene.parts[1].scale: value 0: expected a number other than",
        ),
        ({"mesh": "a.obj", "scale": [1, 0, 1]}, "scene.parts[1].scale: value [1, 0, 1]: expected"),
        (
            {"mesh": "a.obj", "move": 3},
            "scene.parts[1].move: value 3: expected three numbers, such",
        ),
        (
            {"mesh": "a.obj", "turn": [90]},
            "scene.parts[1].turn: value [90]: expected three numbers",
        ),
        (
            {"mesh": "a.obj", "size": 1},
            "scene.parts[1]: unknown key 'size': expected one of mesh, move",
        ),
        ({"mesh": "a.obj", "move": [1e30, 0, 0], "scale": 1e30}, "a.obj: a vertex of 'a' is not a"),
        ("a.obj", "scene.parts[1]: value 'a.obj': expected a mapping (key: value)"),
    ],
)
def test_wrong_parts(part: object, problem: str) -> None:
    assert refusal(parts=[{"mesh": "a.obj"}, part]).startswith(problem)


def test_no_parts() -> None:
    assert refusal(parts=[]).startswith(
        "scene.parts: value []: expected a list such as [{mesh: car"
    )
    assert refusal(parts={"mesh": "a.obj"}).startswith(
        "scene.parts: value {'mesh': 'a.obj'}: expec"
    )


def test_cameras_that_a_file_with_cameras_has_not() -> None:
    expected = "expected 0 ('Front'), 1 ('Down'), 2 ('everything')"
    assert refusal(mesh="seen.glb", camera=3).endswith(f"there is no camera 3: {expected}")
    assert refusal(mesh="seen.glb", camera="Flat").endswith(f"no camera 'Flat': {expected}")
    assert refusal(nff="own.nff", camera="a").endswith("'a': expected parts of its only one")
    assert "or up [0.0, 1.0, 0.0] is along" in refusal(mesh="seen.glb", camera="Down", up="y")


@pytest.mark.parametrize("key", ["camera", "lights", "up"])
def test_views_go_with_scenes_that_are_traced(key: str) -> None:
    value = {"camera": {"angle": 3}, "lights": [], "up": "y"}[key]
    problem = f"scene: {key} goes with a scene that is traced, not with workload"
    assert refusal(workload="rays.npz", **{key: value}) == problem
    assert load_scene({"spd": "tetra", "size": 1, key: value}).objects


def test_groups_of_obj() -> None:
    names = [part.name for part in seen(objects="groups").objects if isinstance(part, MeshPart)]
    assert names == ["a_base", "a_sides"]
    assert (
        len(load_scene("a.obj:groups").objects) == 2 and len(load_scene("a.obj:nodes").objects) == 1
    )
    problem = "seen.glb: objects: groups are of OBJ, this is glb: expected nodes or another cut"
    assert refusal(mesh="seen.glb", objects="groups") == problem


def test_a_part_is_scaled_then_turned_then_moved() -> None:
    part = PartSettings(mesh="a", move=(1, 2, 3), turn=(90, 0, 90), scale=(2, 1, -1))
    x, y, z = (part.matrix @ [*axis, 1] for axis in np.eye(3))
    assert x[:3].tolist() == [1, 4, 3]  # 2 along x, which becomes y
    assert y[:3].tolist() == [1, 2, 4]  # y becomes z
    assert z[:3].tolist() == [0, 2, 3]  # -z becomes y, and then -x


def test_parts_in_one_scene() -> None:
    scene = load_scene(
        {
            "parts": [
                {"mesh": Path("a.obj"), "move": [10, 0, 0]},
                {"mesh": "seen.glb", "scale": 2, "move": [0, 0, 1]},
                {"mesh": "a.obj", "scale": [-1, 1, 1]},
            ],
            "objects": "nodes",
        }
    )
    parts = [part for part in scene.objects if isinstance(part, MeshPart)]
    assert [part.name for part in parts] == ["0.a/a", "1.seen/0", "2.a/a"]
    assert scene.name == "a.obj+2:nodes"
    assert parts[0].vertices.min(axis=0).tolist() == [10, 0, 0]
    assert parts[1].vertices.max(axis=0).tolist() == [2, 2, 1]
    for part in (parts[0], parts[2]):  # both have their outside outside
        corners = part.vertices[part.faces] - part.vertices.mean(axis=0)
        assert np.linalg.det(corners).sum() > 0
    assert scene.camera.eye == (2, 4, 19) and scene.origin.camera == "camera 'Front' of the file"


@pytest.mark.parametrize(
    ("override", "file"),
    [
        ("processors=4", "there/a.obj"),
        ("scene.parts.scale=3", "there/a.obj"),
        ("scene.parts=[{mesh: a.obj}]", "a.obj"),
    ],
)
def test_files_of_parts_are_relative_to_the_configuration(override: str, file: str) -> None:
    Path("there").mkdir()
    Path("there/own.yaml").write_text("scene:\n  parts: [{mesh: a.obj}]\n")
    config = load_config("there/own.yaml", (override,))
    assert config.scene_spec["parts"][0]["mesh"] == file  # type: ignore[index]


def test_what_is_set_of_a_named_camera() -> None:
    scene = {"mesh": "seen.glb", "camera": "Down"}
    config = config_from_mapping({"scene": scene}, ("scene.camera.angle=30",))
    made = config.ray_source.scene
    assert made is not None
    assert (made().camera.eye, made().camera.angle_degrees) == ((0, 50, 0), 30)


def square_lit_by(*lights: dict[str, Any]) -> Scene:
    file: File = one_square()
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": list(lights)}}
    for number in range(len(lights)):
        file.node(
            translation=[0, number, 5],
            rotation=[-HALF, 0, 0, HALF],
            extensions={"KHR_lights_punctual": {"light": number}},
        )
    return load_scene(file.write(Path("lit.glb")))


def test_lights_of_a_file() -> None:
    scene = square_lit_by(
        {"type": "point", "color": [1, 0.5, 0], "intensity": 50},
        {"type": "spot", "intensity": 100},
        {"type": "directional", "intensity": 3},
        {"type": "area"},
    )
    point, spot, sun = scene.lights
    assert (point.position, point.colour) == ((0, 0, 5), (0.5, 0.25, 0))
    assert (spot.position, spot.colour) == ((0, 1, 5), (1, 1, 1))
    # It shines downwards, so it is far above.
    away = np.subtract(sun.position, (0.5, 0.5, 0))
    assert away / np.linalg.norm(away) == pytest.approx([0, 1, 0], abs=1e-6) and away[1] > 1e6
    assert sun.colour == (1, 1, 1) and "lit by 3 lights of the file" in scene.origin.view
    assert scene.origin.notes == (
        "lights of type 'area' are left out",
        "1 spot light without a cone: seen as a point light is",
    )


def test_a_sun_without_a_way_to_shine_is_left_out() -> None:
    file = one_square()
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "directional"}]}}
    file.node(scale=[0, 0, 0], extensions={"KHR_lights_punctual": {"light": 0}})
    scene = load_scene(file.write(Path("dark.glb")))
    assert scene.origin.lights == "2 lights around it all"
    assert scene.origin.notes == (
        "a directional light is left out: its node has no size to shine along",
    )


def test_a_perspective_camera_needs_its_angle() -> None:
    file = one_square()
    file.add("cameras", type="perspective")
    file.node(camera=0)
    file.write(Path("blind.glb"))
    problem = "blind.glb: cameras[0]: expected perspective with its yfov"
    assert refusal(mesh="blind.glb") == problem


def test_lights_are_said_to_be_around_the_scene_whatever_camera_sees_it() -> None:
    for view in ({}, {"camera": {"eye": [9, 9, 9], "at": [0, 0, 0]}}):
        assert seen(**view).origin.lights == "2 lights around it all"
    assert load_scene("seen.glb").origin.view.endswith("of the file, lit by 2 lights around it all")


def test_nff_is_no_mesh() -> None:
    problem = "own.nff: NFF is a scene of its own, no mesh: expected it under scene.nff"
    assert refusal(mesh="own.nff") == problem
    assert refusal(parts=[{"mesh": "own.nff"}]) == problem
