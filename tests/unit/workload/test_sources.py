"""What a user may call a scene."""

import gzip
from collections.abc import Mapping
from pathlib import Path

import pytest

from simmpp.common.errors import ConfigError, InputError, SceneError
from simmpp.config.config import config_from_mapping
from simmpp.scene.nff import write_nff
from simmpp.scene.scene import Scene
from simmpp.scene.spd.generators import nff
from simmpp.workload.sources import load_scene, scene_of

QUAD = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "own.nff").write_text(nff("mountain", 1))
    (tmp_path / "quad.obj").write_text(QUAD)
    (tmp_path / "own.nff.gz").write_bytes(gzip.compress(nff("mountain", 1).encode()))
    (tmp_path / "quad.obj.gz").write_bytes(gzip.compress(QUAD.encode()))
    (tmp_path / "tetra").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("spec", "name", "n_objects"),
    [
        ("mountain:2", "mountain:2", 36),
        ("mount:2", "mountain:2", 36),
        ("jacks", "jacks:1", 9),
        ("tetra:1", "tetra:1", 4),
        ("own.nff", "own", 12),
        ("quad.obj", "quad.obj:components", 1),
        ("quad.obj:nodes", "quad.obj:nodes", 1),
        ("quad.obj:1", "quad.obj:1", 2),
        ("own.nff.gz", "own", 12),
        ("quad.obj.gz", "quad.obj.gz:components", 1),
        ("quad.obj.gz:1", "quad.obj.gz:1", 2),
        (Path("own.nff"), "own", 12),
        ({"spd": "mountain", "size": 2}, "mountain:2", 36),
        ({"spd": "jacks"}, "jacks:1", 9),
        ({"nff": "own.nff"}, "own", 12),
        ({"mesh": "quad.obj"}, "quad.obj:components", 1),
        ({"mesh": "quad.obj", "objects": {"clusters": 1}}, "quad.obj:1", 2),
    ],
)
def test_specs(
    files: Path, spec: str | Path | Mapping[str, object], name: str, n_objects: int
) -> None:
    scene = load_scene(spec)
    assert (scene.name, len(scene.objects)) == (name, n_objects)


def test_a_generated_scene_is_its_text_read_back(files: Path) -> None:
    assert write_nff(load_scene("mountain:1")) == write_nff(load_scene("own.nff"))


@pytest.mark.parametrize(
    ("spec", "error", "problem"),
    [
        ("foo", ConfigError, "no scene 'foo': no such file, and the generated scenes are balls"),
        ("Mountain:3", ConfigError, "no scene 'Mountain': expected 'mountain'"),
        ({"mesh": "in/Tetra"}, ConfigError, "no scene 'Tetra': expected 'tetra'"),
        ("TETRA", ConfigError, "no scene 'TETRA': expected 'tetra'"),
        ("quad.obj:0", ConfigError, "scene.objects: value {'clusters': 0}: expected nodes,"),
        ("foo:3", ConfigError, "no scene 'foo': no such file"),
        ("mountain:", ConfigError, "scene.size: value '': expected an integer from 1"),
        ("mountain:2.5", ConfigError, "scene.size: value '2.5': expected an integer from 1"),
        ("mountain:99", ConfigError, "at most 7, got 99"),
        ("", ConfigError, "scene: value '': expected a name such as mountain:5, a file or a"),
        ("a\0.nff", ConfigError, "scene: value 'a\\x00.nff': expected a name"),
        (7, ConfigError, "scene: value 7: expected a name such as mountain:5, a file or a"),
        ("missing.nff", SceneError, "missing.nff: can't read the file: No such file"),
        ("missing.glb", SceneError, "missing.glb: can't read the file: No such file"),
        ("x" * 5000 + ".nff", SceneError, "can't read the file"),
        (".", SceneError, "can't read the file: Is a directory"),
        (
            "quad.obj:lumps",
            ConfigError,
            "quad.obj:lumps: value 'lumps': expected nodes, components",
        ),
        ({}, ConfigError, "expected one of spd, nff, mesh, parts, cells, workload, got none"),
        ({"spd": "tree", "nff": "own.nff"}, ConfigError, "workload, got spd and nff"),
        (
            {"spd": "tree", "sise": 2},
            ConfigError,
            "scene: unknown key 'sise': did you mean 'size'?",
        ),
        ({"spd": "tree", "size": "2"}, ConfigError, "scene.size: value '2': expected an integer"),
        ({"spd": "tree", "size": True}, ConfigError, "scene.size: value true: expected an integer"),
        ({"spd": "oak"}, ConfigError, "scene.spd: value 'oak': expected balls, "),
        ({"spd": ["tree"]}, ConfigError, "scene.spd: value ['tree']: expected balls, "),
        ({"nff": "a\0.nff"}, ConfigError, "scene.nff: value 'a\\x00.nff': expected a text"),
        (
            {"mesh": "quad.obj", "objects": {"clusters": 0}},
            ConfigError,
            "expected nodes, components",
        ),
        ({"mesh": "quad.obj", "objects": 3}, ConfigError, "expected nodes, components"),
        ({"mesh": "quad.obj", "size": 3}, ConfigError, "scene: size goes with spd only"),
        ("rays.parquet", ConfigError, "scene: expected a scene to trace; a workload file has rays"),
    ],
)
def test_wrong_specs(files: Path, spec: object, error: type[InputError], problem: str) -> None:
    with pytest.raises(error) as caught:
        load_scene(spec)  # type: ignore[arg-type]
    assert problem in str(caught.value) and "\n" not in str(caught.value)


def test_binary_files_are_no_nff(tmp_path: Path) -> None:
    file = tmp_path / "noise.nff"
    file.write_bytes(bytes(range(256)) * 4)
    with pytest.raises(SceneError, match=r"noise.nff:1: not an NFF text"):
        load_scene(file)


def test_a_byte_order_mark_and_odd_comments_do_no_harm(tmp_path: Path) -> None:
    file = tmp_path / "marked.nff"
    file.write_bytes(b"\xef\xbb\xbf# caf\xe9\r\n" + nff("jacks", 1).encode())
    assert len(load_scene(file).objects) == 9


def configured(spec: str) -> Scene:
    return scene_of(config_from_mapping({"scene": spec}).ray_source, "scene")()


@pytest.mark.parametrize("spec", ["foo", "Tetra:3", "quad.obj:lumps", "mountain:9", "", "x.npz"])
def test_a_configuration_says_the_same(files: Path, spec: str) -> None:
    with pytest.raises(InputError) as caught:
        load_scene(spec)
    with pytest.raises(InputError) as of_configuration:
        configured(spec)
    assert str(of_configuration.value) == str(caught.value)
