"""The JSON schema accepts what the loader accepts, and refuses misspelt keys at any depth."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from simmpp.cli import main
from simmpp.common.errors import ConfigError
from simmpp.common.yamlfile import read_yaml
from simmpp.config.config import config_from_mapping
from simmpp.config.keys import keys
from simmpp.config.schema import json_schema

ROOT = Path(__file__).parents[3]
FILES = [
    *sorted(ROOT.glob("configs/*.yaml")),
    *sorted(ROOT.glob("simmpp/studies/nebel98/*.yaml")),
    ROOT / "tests/golden/rows/sweep.yaml",
]
SCHEMA = Draft202012Validator(json_schema())


def accepts(data: object) -> bool:
    return bool(SCHEMA.is_valid(data))


def loads(data: dict[str, object]) -> bool:
    try:
        config_from_mapping(data)
    except ConfigError:
        return False
    return True


def test_it_is_what_the_command_prints() -> None:
    Draft202012Validator.check_schema(SCHEMA.schema)
    assert json.loads(CliRunner().invoke(main, ["keys", "--schema"]).stdout) == SCHEMA.schema


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_every_configuration_is_accepted(path: Path) -> None:
    assert not list(SCHEMA.iter_errors(read_yaml(path).data))


def nested(name: str, value: object) -> dict[str, Any]:
    """A configuration with one dotted key."""
    *path, last = name.split(".")
    data: Any = {last: value}
    for part in reversed(path):
        data = {part: data}
    return data if path[:1] == ["scene"] else {"scene": "rings:1"} | data


@pytest.mark.parametrize("name", keys())
def test_a_misspelt_key_is_refused_at_any_depth(name: str) -> None:
    wrong = f"{name[:-1]}_{name[-1]}"
    for data in (nested(wrong, 1), {"scene": "rings:1", "sweep": {wrong: [1]}}):
        assert not accepts(data) and not loads(data)
    point = {"scene": "rings:1", "sweep": {"points": [{"name": "a", wrong: 1}]}}
    assert not accepts(point) and not loads(point)


@pytest.mark.parametrize("name", keys())
def test_every_key_is_described(name: str) -> None:
    node: Any = SCHEMA.schema
    for part in keys()[name].pointer.removeprefix("#/").split("/"):
        node = node[part]
    assert node["description"] == keys()[name].meaning


SHORT_FORMS: list[tuple[str, object]] = [
    ("scene", "mountain:5"),
    ("scene", {"mesh": "x.obj", "objects": {"clusters": 3}}),
    ("scene", {"mesh": "x.obj", "objects": "groups", "up": "z", "camera": "Top", "lights": []}),
    ("scene", {"nff": "x.nff", "camera": 0, "lights": [{"position": [0, 1.5, 2]}]}),
    ("scene", {"spd": "tetra", "camera": {"name": 1, "eye": [0, 1, 2], "angle": 0.5}}),
    ("scene", {"parts": [{"mesh": "a.obj", "scale": 2}, {"mesh": "a.obj", "scale": [1, -1, 2]}]}),
    ("picture.resolution", [320, 180]),
    ("picture.resolution", "own"),
    ("sweep", {"picture.resolution": [8, [16, 9], "own"], "scene.camera": ["Top", {"angle": 3}]}),
    ("policy", "ray"),
    ("policy", {"name": "ray", "batch": 3}),
    ("policy", ["object", {"min_load": "12%", "load_info": {"refresh": "5 ms"}}]),
    ("policy", [{"min_load": 100, "load_info": "none"}]),
    ("machine.test", "4 us"),
    ("machine.test", 0),
    ("machine.test", {"sphere": "1 us"}),
    ("machine.pack", {"fixed": "1 us", "rays": {"bandwidth": "unlimited"}}),
    ("machine.link_bandwidth", "4.68 GB/s"),
    ("machine.levels", {"node": {"size": 4, "gap": "1 us"}, "system": {"ports": 2}}),
    ("sweep", {"machine.levels.node.latency": ["1 us", 0], "processors": [4]}),
    ("machine.header_bytes", "64 B"),
    ("memory.fraction", "1/64"),
    ("memory.fraction", 1),
    ("tolerance", "none"),
    ("tolerance", None),
    ("memory.bytes", None),
    *(("memory.transient", kept) for kept in (0, 3, "0%", "5 %", "100%", "1/64", "x")),
    ("placement.pixels", "rows"),
    ("placement.pixels", {"cells": 1}),
    ("sweep", {"placement.pixels": ["blocks", {"cells": 8}], "memory.transient": [0, "5%", "x"]}),
    ("sweep", {"processors, machine.shape": [[8, [2, 2, 2]]], "policy": ["ray", ["object"]]}),
]


@pytest.mark.parametrize(("name", "value"), SHORT_FORMS)
def test_short_forms_are_accepted(name: str, value: object) -> None:
    assert accepts(nested(name, value)) and loads(nested(name, value))


MISTAKES: list[tuple[str, object]] = [
    ("scene", 3),
    ("scene.spd", "x"),
    ("scene.objects", "triangles"),
    ("processors", 0),
    ("processors", 65537),
    ("processors", "8"),
    ("processors", True),
    ("processors", None),
    ("picture.resolution", 16385),
    ("picture.resolution", [16, 9, 3]),
    ("picture.resolution", [16, 0]),
    ("picture.resolution", "auto"),
    ("scene", {"spd": "tetra", "up": "x"}),
    ("scene", {"spd": "tetra", "camera": {"angle": 180}}),
    ("scene", {"spd": "tetra", "camera": {"eye": [1, 2]}}),
    ("scene", {"spd": "tetra", "camera": {"fov": 30}}),
    ("scene", {"spd": "tetra", "lights": {"position": [0, 1, 2]}}),
    ("scene", {"spd": "tetra", "lights": [{"colour": [0, 1, 2]}]}),
    ("scene", {"parts": [{"mesh": "a.obj", "scale": 0}]}),
    ("scene", {"parts": []}),
    ("scene", {"parts": [{"move": [0, 1, 2]}]}),
    ("picture.samples", "centers"),
    ("picture.shadows", "on"),
    ("memory", 3),
    ("memory.fraction", 1.2),
    ("memory.fraction", "12:30"),
    ("memory.bytes", 64),
    ("memory.bytes", "64 us"),
    ("machine.preset", "t3x"),
    ("machine.shape", 8),
    ("machine.shape", [2, 2]),
    ("machine.latency", 2),
    ("machine.latency", "2 MB"),
    ("machine.latency", "-2 us"),
    ("machine.test", 1),
    ("machine.test", {"spere": "1 us"}),
    ("machine.link_bandwidth", "3 MB"),
    ("machine.contention", "link"),
    ("machine.topology", "ring"),
    ("machine.levels", "node"),
    ("machine.levels", {"node": {"sise": 4}}),
    ("machine.quantum", 0),
    ("memory.transient", 0.1),
    ("memory.transient", "1"),
    ("memory.transient", "some"),
    ("placement.owners", "x"),
    ("placement.pixels", "row"),
    ("placement.pixels", {"cells": 0}),
    ("placement.pixels", {"cells": "8"}),
    ("placement.pixels", {}),
    ("policy", "objct"),
    ("policy", []),
    ("policy", [1]),
    ("policy", None),
    ("policy.batch", 0),
    ("policy.min_load", 0.1),
    ("policy.min_load", -1),
    ("policy.load_info", "all"),
    ("policy.load_info", {"refresh": 5}),
    ("policy.label", 3),
    ("policy.label", ""),
    ("seeds", []),
    ("seeds", [1, 1]),
    ("seeds", [2**63]),
    ("method", "magic"),
    ("engine", "magic"),
    ("sweep", 3),
    ("sweep", {"processors": 8}),
    ("sweep", {"processors": [0]}),
    ("sweep", {"processors": []}),
    ("sweep", {"seeds": [1]}),
    ("sweep", {"points": [{"processors": 8}]}),
    ("check.speedup", "fast"),
]


@pytest.mark.parametrize(("name", "value"), MISTAKES)
def test_schema_and_loader_refuse_the_same(name: str, value: object) -> None:
    assert not accepts(nested(name, value)) and not loads(nested(name, value))


PLAIN_KEYS = [
    "processors", "ready_order", "engine", "method", "picture.resolution",
    "picture.samples", "picture.max_depth", "picture.shadows", "memory.residents", "memory.bytes",
    "memory.transient", "memory.fraction", "placement.owners", "placement.pixels", "machine.test",
    "machine.latency", "machine.header_bytes", "machine.quantum", "machine.contention",
    "machine.preset", "policy", "policy.name", "policy.batch", "policy.merge_requests",
    "check.speedup",
]  # fmt: skip
VALUES = st.sampled_from([
    0, 1, 2, 8, 100, 101, 16384, 16385, 65536, 65537, 2**31 - 1, 2**31, -1, 0.5, 1.5, True, False,
    "centres", "hot", "tiles", "links", "none", "ray", "object", "simpy", "simulate", "depth-first",
    "t3d", "12 us", "1 KiB", "3 MB/s", "12%", "1/64", "x", "", [], {}, [8], {"x": 1},
    "rows", {"cells": 1}, {"cells": 0}, {"cells": 8, "x": 1},
])  # fmt: skip


@given(name=st.sampled_from(PLAIN_KEYS), value=VALUES)
def test_schema_and_loader_agree_on_plain_values(name: str, value: object) -> None:
    data = nested(name, value)
    assert accepts(data) == loads(data)
