"""The package's machines: complete, sourced, and overridden key by key."""

from dataclasses import replace
from math import inf
from typing import Any

import pytest

from simmpp.common.errors import ConfigError
from simmpp.common.strict import structure
from simmpp.machine.constants import Constants
from simmpp.machine.listing import text_of
from simmpp.machine.machine import UNLIMITED, CopyCost, TestCost
from simmpp.machine.presets import OVERRIDDEN, layered, load_preset, machine, preset_names

TORI = ["bluegene-l", "t3d", "t3e", "t3e-shmem", "tpu-v4", "xe6-hopper"]
CHOICES = ("topology", "service")
"""Words, which have no range."""
NAMES = sorted([*TORI, "cloud", "cpu-cluster", "gpu-cluster", "gpu-node"])


def test_the_presets_there_are() -> None:
    assert preset_names() == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_every_constant_has_a_source(name: str) -> None:
    preset = load_preset(name)
    assert preset.sources.keys() == preset.texts.keys()
    for key, source in preset.sources.items():
        assert len(source) > 15, key
        if source.startswith("ESTIMATE"):
            assert source.startswith("ESTIMATE: ") and key in {*preset.spans, *CHOICES}, key
        else:
            assert any(char.isdigit() or char == '"' for char in source), key


@pytest.mark.parametrize("name", NAMES)
def test_every_preset_makes_a_machine_and_cites_each_constant(name: str) -> None:
    made = machine(name, processors=8)
    assert made.shape == ((2, 2, 2) if name in TORI else (8, 1, 1))
    assert made.sources.keys() == load_preset(name).constants.flat().keys()
    assert len(made.sources) >= 34


@pytest.mark.parametrize("name", NAMES)
def test_every_constant_lies_in_its_range(name: str) -> None:
    known = load_preset(name).known
    assert known.keys() == load_preset(name).constants.flat().keys()
    for key, of in known.items():
        high = inf if key.endswith("bandwidth") and of.high == UNLIMITED else of.high
        value = inf if key.endswith("bandwidth") and of.value == UNLIMITED else of.value
        assert of.low <= value <= high, key
        assert of.source == load_preset(name).source(key)


def test_ranges_are_numbers_by_the_constant_that_they_are_of() -> None:
    known = load_preset("t3e").known
    assert known["send_startup"][:3] == (10_000_000, 5_000_000, 20_000_000)
    assert known["unpack.object.bandwidth"][:3] == (256_000_000, 150_000_000, 340_000_000)
    assert known["test.cone"][:3] == (4_000_000, 400_000, 4_000_000)
    assert known["test.per_triangle"].is_exact and not known["quantum"].is_exact
    assert load_preset("t3e-shmem").known["pack.rays.bandwidth"].high == UNLIMITED


@pytest.mark.parametrize("name", ["t3e", "gpu-cluster", "cpu-cluster"])
def test_each_end_of_a_range_can_be_set(name: str) -> None:
    """Who asks what depends on a constant sets it to what ``text_of`` writes."""
    for key, known in load_preset(name).known.items():
        for end in {known.low, known.high}:
            text = text_of(key, end)
            overrides: Any = int(text) if text.isdigit() else text
            for part in reversed(key.split(".")):
                overrides = {part: overrides}
            assert structure(Constants, overrides, {}).flat()[key] == end


def test_what_is_set_above_a_preset_has_its_own_range_or_none() -> None:
    constants = structure(Constants, {"send_startup": "5 us", "levels": {"node": {}}}, {})
    known = layered("gpu-cluster", constants).known
    assert known["send_startup"] == (5_000_000, 5_000_000, 5_000_000, OVERRIDDEN)
    assert known["levels.node.latency"][1:3] == (80_000, 700_000)
    other = structure(Constants, {"levels": {"room": {"size": 4}}}, {})
    assert not [key for key in layered("gpu-cluster", other).ranges if key.startswith("levels")]


def test_t3e_has_the_constants_that_its_file_says() -> None:
    t3e = machine("t3e")
    assert (t3e.send_startup_ps, t3e.receive_startup_ps) == (10_000_000, 20_000_000)
    assert t3e.pack == t3e.unpack == (CopyCost(0, 256_000_000),) * 4
    assert t3e.test == TestCost(4_000_000, 4_000_000, 4_000_000, 4_000_000, 0)
    assert (t3e.ray_ps, t3e.quantum, t3e.probe_ps) == (6_000_000, 64, 0)
    assert (t3e.header_bytes, t3e.request_bytes, t3e.ray_bytes) == (64, 8, 128)
    assert (t3e.link_bytes_per_s, t3e.injection_bytes_per_s) == (480_000_000, 340_000_000)
    assert (t3e.latency_ps, t3e.hop_latency_ps) == (2_000_000, 50_000)


def test_overrides_change_what_they_name_only() -> None:
    overrides = {
        "send_startup": "5 us",
        "test": {"sphere": "1 us"},
        "pack": {"bandwidth": "unlimited", "rays": {"fixed": "7 ns"}},
    }
    made = machine("t3e", overrides, processors=8)
    assert made.send_startup_ps == 5_000_000
    assert made.receive_startup_ps == 20_000_000
    assert made.test == TestCost(1_000_000, 4_000_000, 4_000_000, 4_000_000, 0)
    assert made.pack == (*[CopyCost(0, UNLIMITED)] * 2, CopyCost(7000, UNLIMITED), made.pack[3])
    assert made.unpack == (CopyCost(0, 256_000_000),) * 4
    assert made.sources["pack.rays.fixed"] == OVERRIDDEN
    assert made.sources["pack.object.fixed"].startswith("ESTIMATE")


def test_contention_is_a_choice_beside_the_constants() -> None:
    assert machine("t3e").contention == "none"
    made = machine("t3e", {"contention": "links"})
    assert made == replace(machine("t3e"), contention="links")
    assert "contention" not in made.sources


def test_one_time_for_all_tests_replaces_the_kinds() -> None:
    assert machine("t3e", {"test": "2 us"}).test == TestCost(2_000_000, *[2_000_000] * 3, 0)


def test_shapes() -> None:
    assert machine(processors=128).shape == (8, 4, 4)
    assert machine(processors=12, shape=(12, 1, 1)).shape == (12, 1, 1)
    assert machine(overrides={"shape": [2, 2, 2]}, processors=8).shape == (2, 2, 2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"preset": "t3x"}, "preset: value 't3x': expected one of bluegene-l, cloud"),
        ({"preset": "../t3e"}, "preset: value '../t3e': expected one of"),
        ({"processors": 0}, "processors: value 0: expected an integer from 1 to 65536"),
        ({"shape": (4, 4, 5)}, "shape: value [4, 4, 5]: expected three integers whose product is"),
        (
            {"overrides": {"sned_startup": "1 us"}},
            "unknown key 'sned_startup': did you mean 'send_startup'?",
        ),
        ({"overrides": {"ray": 6}}, "ray: value 6: expected a time such as '12 us'"),
        ({"overrides": {"test": {"sphere": "1"}}}, "test.sphere: value '1': expected a time"),
        ({"overrides": {"contention": "link"}}, "contention: value 'link': expected none or links"),
        ({"overrides": {"quantum": 0}}, "quantum: value 0: expected an integer from 1"),
        ({"overrides": {"shape": [2, 2]}}, "shape: value [2, 2]: expected three positive"),
    ],
)
def test_wrong_machines(arguments: dict, message: str) -> None:  # type: ignore[type-arg]
    with pytest.raises(ConfigError) as caught:
        machine(**arguments)
    assert str(caught.value).startswith(message)
