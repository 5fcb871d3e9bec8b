"""A scene of one's own through the commands: which view it has is said, pictures have its shape."""

from __future__ import annotations

from pathlib import Path

import pytest
from calls import begin_in, refused, simmpp
from PIL import Image
from rooms import room, yard


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("d").mkdir()
    room(Path("d"))
    yard(Path("d"))
    with Path("d/yard.obj").open("a") as file:
        file.write("mtllib lost.mtl\n")
    scene = "scene: {mesh: room.glb, objects: nodes}\n"
    Path("d/room.yaml").write_text(scene + "picture: {resolution: [24, 10]}\nprocessors: 4\n")


def size(file: str) -> tuple[int, int]:
    with Image.open(file) as picture:
        return picture.size


def test_a_scene_says_its_cameras_and_what_was_not_read() -> None:
    lines = simmpp("scene", "d/room.glb").stdout.splitlines()
    assert "seen by camera 'Camera' of the file, lit by 2 lights of the file" in lines
    assert "cameras: 0 ('Camera'), 1 ('everything')" in lines
    done = simmpp("scene", "d/yard.yaml", "--set", "scene.lights=[]", "--preview", "y.png")
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert "seen by a camera as set, z up, lit by 0 lights as set" in lines
    lost = "mtllib 'lost.mtl' is left out: can't read the file: No such file or directory"
    assert lost in lines
    assert size("y.png") == (512, 288)


def test_a_run_says_its_view_and_makes_its_picture() -> None:
    done = simmpp("run", "d/room.yaml", "--picture", "r.png", "--figures", "f", "--verify")
    assert done.exit_code == 0, done.output
    view = "simmpp: room.glb:nodes: seen by camera 'Camera' of the file, lit by 2 lights of the"
    assert view in done.stderr
    assert done.stdout.startswith("room.glb:nodes: 24 x 10 primary rays, ")
    assert size("r.png") == (24, 10)
    assert done.stdout.count("the picture of its tests is the same") == 3
    other = simmpp("run", "d/room.yaml", "--set", "scene.camera=everything")
    assert "seen by a camera that sees everything, lit by 2 lights of the file" in other.stderr
    assert other.stdout.splitlines()[3:] != done.stdout.splitlines()[3:]


@pytest.mark.parametrize("pixels", ["rows", "tiles", "{cells: 3}"])
def test_pixels_are_dealt_and_rays_exported(pixels: str) -> None:
    done = simmpp("workload", "d/room.yaml", "--export", "d/rays.parquet")
    assert done.exit_code == 0, done.output
    Path("d/rays.yaml").write_text("scene: rays.parquet\nprocessors: 4\n")
    traced, again = (
        simmpp("run", f"d/{name}.yaml", "--set", f"placement.pixels={pixels}").stdout
        for name in ("room", "rays")
    )
    assert traced.splitlines()[1:] == again.splitlines()[1:] and "24 x 10" in again


def test_a_part_that_is_missing_is_named_as_it_is_looked_for() -> None:
    Path("d/gone.yaml").write_text("scene:\n  parts:\n  - mesh: room.glb\n  - mesh: gone.glb\n")
    assert (
        refused("run", "d/gone.yaml")
        == "d/gone.glb: can't read the file: No such file or directory"
    )
    line = "d/room.yaml:1: scene: up goes with a scene that is traced, not with workload"
    Path("d/room.yaml").write_text("scene: {workload: rays.parquet, up: z}\n")
    assert refused("run", "d/room.yaml") == line
