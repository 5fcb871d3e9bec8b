"""The view of a scene against Mitsuba 3, whose camera, surfaces and directions are its own.

A GLB whose nodes are mirrored and sheared, with its own camera and lights, and two OBJ files put
together, z up; each with a mirror and glass, 320 x 180 pixels. At an edge of an object the float32
of Mitsuba may decide otherwise.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from oracles.mitsuba_room import MitsubaRoom, compare
from rooms import SHAPE, Room, room, yard

from simmpp.config.config import load_config
from simmpp.scene.scene import Scene
from simmpp.workload.sources import load_scene

pytest.importorskip("mitsuba", reason="there are wheels for x86-64 only")


def of_the_file(folder: Path) -> Scene:
    return load_scene(folder / "room.glb")


def of_the_configuration(folder: Path) -> Scene:
    config = load_config(folder / "yard.yaml")
    assert config.picture.pixels == SHAPE[::-1] and config.ray_source.scene is not None
    return config.ray_source.scene()


@pytest.mark.parametrize(("make", "load"), [(room, of_the_file), (yard, of_the_configuration)])
def test_the_same_objects_are_where_mitsuba_sees_them(
    tmp_path: Path, make: Callable[[Path], Room], load: Callable[[Path], Scene]
) -> None:
    there = make(tmp_path)
    scene = load(tmp_path)
    assert [light.position for light in scene.lights] == there.lights
    assert sum(m.transmits for m in scene.materials) == 1
    found = compare(scene, MitsubaRoom(there))
    assert found["primary"].rays == SHAPE[0] * SHAPE[1] and found["primary"].share >= 0.999
    for kind in ("mirrored", "refracted"):
        assert found[kind].rays > 2000 and found[kind].share >= 0.99, kind
