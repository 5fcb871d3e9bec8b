"""The keys are declared once: the table, the command and the schema tell the same of each."""

from __future__ import annotations

import json
from dataclasses import fields
from fractions import Fraction
from pathlib import Path

import pytest
from click.testing import CliRunner

from simmpp.cli import main
from simmpp.common.errors import ConfigError
from simmpp.config.config import config_from_mapping, described
from simmpp.config.keys import default_of, find_keys, key_table, keys, listed_keys, with_table
from simmpp.config.reading import load_reading
from simmpp.config.settings import DEFAULT_READING
from simmpp.machine.constants import OTHERS, UNLIKE, key_of
from simmpp.machine.machine import Machine
from simmpp.machine.presets import DEFAULT_PRESET, load_preset, preset_names

README = Path(__file__).parents[3] / "configs" / "README.md"
CONSTANTS = [key_of(field.name) for field in fields(Machine) if field.name not in OTHERS]
WORDS = ("topology", "service", "contention")
OTHERWISE = ("shape", "pack", "unpack", "test", "levels", "fat_tree", *UNLIKE, *WORDS)
UNKNOWN = ("power", "price")
"""Constants that some presets have no source for."""
SCALARS = [key for key in CONSTANTS if key not in (*OTHERWISE, *UNKNOWN)]


def test_every_key_says_what_it_takes_and_means() -> None:
    lines = [line.split(" | ") for line in key_table().splitlines()[2:]]
    names = [line[0].strip("|` ") for line in lines]
    assert names == list(dict.fromkeys(names)) == [key.name for key in listed_keys()]
    assert {"scene.size", "machine.pack.bandwidth", "memory.fraction", "sweep"} <= set(names)
    assert all(len(line) == 5 and line[2] and line[4].strip(" |") for line in lines)


def test_the_readme_has_the_present_table() -> None:
    text = README.read_text(encoding="utf-8")
    assert with_table(text) == text, "run: python -m simmpp.config.keys configs/README.md"


@pytest.mark.parametrize("constant", SCALARS)
def test_a_constant_of_the_machine_is_told_of_everywhere(constant: str) -> None:
    key = keys()[f"machine.{constant}"]
    default = default_of(key.name, key.expect, None, load_reading(DEFAULT_READING))
    plain = default_of(key.name, key.expect, None, load_reading("plain"))
    assert plain == f"{load_preset(DEFAULT_PRESET).texts[constant]} ({DEFAULT_PRESET})"
    assert key.expect.unit and key.expect.schema and key.expect.takes and key.default == default
    assert len(key.meaning) > 8 and key.meaning.endswith(".")
    assert f"| `{key.name}` |" in README.read_text(encoding="utf-8")
    printed = CliRunner().invoke(main, ["keys", key.name], env={"COLUMNS": "500"}).stdout
    for name in preset_names():
        preset = load_preset(name)
        assert constant in preset.constants.flat()
        assert preset.texts[constant] in printed and preset.source(constant)[:30] in printed


def test_what_a_user_does_not_set_is_no_key() -> None:
    assert [key for key in CONSTANTS if f"machine.{key}" not in keys()] == []
    assert [name for name in OTHERS if f"machine.{name}" in keys()] == []
    assert "policy.refresh_ps" not in keys()  # written as `load_info: {refresh: 5 ms}`


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("memry", "unknown key 'memry': did you mean 'memory'?"),
        ("memory.fracton", "memory: unknown key 'fracton': did you mean 'fraction'?"),
        ("hop_latency", "unknown key 'hop_latency': did you mean 'machine.hop_latency'?"),
        ("processors.x", "'processors' has no keys of its own"),
    ],
)
def test_unknown_keys(name: str, line: str) -> None:
    with pytest.raises(ConfigError) as caught:
        find_keys(name)
    assert str(caught.value) == line
    done = CliRunner().invoke(main, ["keys", name])
    assert (done.exit_code, done.stderr) == (2, f"simmpp: error: {line}\n")


def test_keys_within_a_key() -> None:
    assert [key.name for key in find_keys("placement")] == [
        "placement", "placement.owners", "placement.pixels", "placement.islands",
        "placement.rounds", "placement.tallies",
    ]  # fmt: skip
    assert [key.name for key in find_keys("sweep.memory.fraction")] == ["sweep"]
    assert "pack.rays.fixed" in CliRunner().invoke(main, ["keys", "machine.pack"]).stdout


def test_what_is_described_can_be_loaded_again() -> None:
    config = config_from_mapping(
        {
            "scene": "rings:1",
            "picture": {"resolution": 9},
            "machine": {
                "latency": "13.3 ns", "test": "2 us", "link_bandwidth": "unlimited", "probe": 0,
                "shape": [8, 1, 1], "pack": {"rays": {"fixed": "1 ps"}}, "ray_bytes": "1 KiB",
            },
            "memory": {"bytes": "64 MB", "transient": "100%"},
            "placement": {"pixels": {"cells": 8}},
            "policy": ["ray", {"label": "x", "min_load": "1/3", "load_info": {"refresh": "5 ms"}}],
            "tolerance": "2%",
            "check": {"speedup": 0.01},
            "processors": 8,
            "sweep": {"memory.fraction": [0.1, Fraction(1, 3)]},
        }
    )  # fmt: skip
    plain = described(config)
    assert plain["machine"]["latency"] == "13.3 ns"
    assert (plain["memory"]["transient"], plain["placement"]["pixels"]) == ("1/1", {"cells": 8})
    assert plain["policy"][1]["load_info"] == {"refresh": "5 ms"}
    again = config_from_mapping(json.loads(json.dumps(plain)))
    assert described(again) == plain
    sweep = {"sweep": config.settings.sweep}
    assert again.settings.model_copy(update=sweep) == config.settings
