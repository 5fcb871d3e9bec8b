"""Readings: what they set, under what is said and over what is not, and what is wrong in one."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.common.errors import ConfigError
from simmpp.config.config import Config, config_from_mapping, load_config
from simmpp.config.keys import default_of, keys
from simmpp.config.reading import Line, load_reading, reading_names
from simmpp.config.schema import json_schema
from simmpp.config.settings import DEFAULT_READING
from simmpp.machine.machine import TestCost
from simmpp.machine.presets import OVERRIDDEN, machine, preset_names
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.policy.parameters import POLICIES, PolicyParameters
from simmpp.run.point import policies_of
from simmpp.sweeps.grid import comparisons
from simmpp.sweeps.plan import plan_of

SCENE = "tetra:2"
ROOT = Path(__file__).parents[3]
OWN = ROOT / "experiments" / "nebel98" / "readings"
CONFIGS = ROOT / "configs"
FILES = sorted(path for path in OWN.glob("*.yaml"))


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def of(reading: str, **given: Any) -> Config:
    return config_from_mapping({"scene": SCENE, "reading": reading, **given})


def written(text: str, name: str = "own.yaml") -> str:
    """The name of a file with such a reading."""
    Path(name).write_text(f"description: one's own\n{text}")
    return name


def leaf(value: str, source: str = "one's own") -> str:
    return f'{{value: {value}, source: "{source}"}}'


# --- those that there are ---


@pytest.mark.parametrize("name", [*reading_names(), *map(str, FILES)])
def test_every_value_has_a_source(name: str) -> None:
    reading = load_reading(name)
    assert len(reading.description) > 15
    assert reading.lines
    for line in reading.lines:
        assert len(line.source) > 15, line
        if line.source.startswith("ESTIMATE") and line.key.startswith("machine."):
            assert line.span, line


def test_plain_is_what_the_code_has_and_sets_what_others_set() -> None:
    plain = of("plain", policy=[*POLICIES])
    assert plain.settings.placement == PlacementRules()
    assert plain.memory == Memory()
    assert plain.settings.policy == tuple(map(PolicyParameters, POLICIES))
    assert plain.machine_for(64) == machine("t3e", processors=64)
    assert {line.key for line in load_reading("plain").lines} >= {
        line.key
        for name in reading_names()
        for line in load_reading(name).lines
        if not line.key.startswith("machine.")
    }


def test_mixed() -> None:
    mixed = of("mixed", policy=["object", "concurrent"])
    assert mixed.settings.placement == PlacementRules(pixels="rows")
    assert mixed.memory == Memory(transient="x")
    assert mixed.settings.policy == (
        PolicyParameters("object"),
        PolicyParameters("concurrent", packing="all", ask_at_least=64),
    )
    t3e = machine("t3e", {"test": "1 us", "ray": "500 ns", "quantum": 16})
    assert mixed.machine_for(64) == t3e
    startups = t3e.send_startup_ps, t3e.receive_startup_ps
    assert startups == (10_000_000, 20_000_000)


def test_a_configuration_without_a_reading_has_the_default_one() -> None:
    named, unnamed = of(DEFAULT_READING), config_from_mapping({"scene": SCENE})
    assert named.settings == unnamed.settings
    assert named.machine_for(64) == unnamed.machine_for(64)


def test_the_configuration_that_writes_all_defaults_out_has_them() -> None:
    written = load_config(CONFIGS / "nebel.yaml")
    left = config_from_mapping({"scene": "mountain:5", "policy": ["object", "ray", "concurrent"]})
    assert written.settings.placement == left.settings.placement
    assert (written.memory, written.settings.policy) == (left.memory, left.settings.policy)
    assert written.machine_for(64) == left.machine_for(64)
    assert written.lines_of_reading == []


# --- code < preset < reading < configuration < --set ---

Layer = dict[str, Any]
PACKINGS = ("none", "requests", "all")
KINDS = ("request", "object", "rays", "load")
US = 1_000_000
VALUES: dict[str, st.SearchStrategy[Any]] = {
    "placement.pixels": st.sampled_from(["rows", "tiles", "interleaved", "blocks"]),
    "placement.owners": st.sampled_from(["morton", "round_robin", "bisection"]),
    "memory.transient": st.integers(0, 9),
    "policy.concurrent.packing": st.sampled_from(PACKINGS),
    "policy.concurrent.ask_at_least": st.integers(1, 99),
    "machine.quantum": st.integers(1, 99),
    "machine.test": st.integers(1, 9).map("{} us".format),
    "machine.test.sphere": st.integers(1, 9).map("{} us".format),
    "machine.pack.fixed": st.integers(1, 9).map("{} us".format),
    "machine.pack.rays.fixed": st.integers(1, 9).map("{} us".format),
}
LAYER = st.fixed_dictionaries({}, optional=VALUES).filter(
    lambda layer: not {"machine.test", "machine.test.sphere"} <= layer.keys()
)


SECOND = {"name": "concurrent", "label": "second"}


def tree(layer: Layer, *, sourced: bool = False) -> dict[str, Any]:
    """Dotted keys as nested mappings: a reading's, or a configuration's."""
    root: dict[str, Any] = {}
    for key, value in layer.items():
        *path, last = key.split(".")
        if sourced and path[0] == "machine":
            path.insert(1, "t3e")
        node = root
        for part in path:
            node = node.setdefault(part, {})
        node[last] = {"value": value, "source": "drawn"} if sourced else value
    return root


def as_configuration(layer: Layer, form: str) -> dict[str, Any]:
    """The same with the policy in one of the forms that a configuration may have it in."""
    data = {"scene": SCENE, "reading": "own.yaml", **tree(layer)}
    policy = {"name": "concurrent", **data.pop("policy", {}).get("concurrent", {})}
    forms = {"mapping": policy, "name": "concurrent", "list": [policy, SECOND]}
    return data | ({"policy": forms[form]} if form in forms else {})


def assignments(layer: Layer) -> list[str]:
    return [f"{key.replace('.concurrent', '')}={value}" for key, value in layer.items()]


def last(key: str, default: Any, *layers: Layer) -> Any:
    return next((layer[key] for layer in reversed(layers) if key in layer), default)


def costs_ps(*layers: Layer) -> TestCost:
    """A time for all kinds replaces them all, one of a kind that kind's."""
    sphere_us = others_us = 4
    for layer in layers:
        if "machine.test" in layer:
            sphere_us = others_us = int(layer["machine.test"].split()[0])
        if "machine.test.sphere" in layer:
            sphere_us = int(layer["machine.test.sphere"].split()[0])
    return TestCost(sphere_us * US, *[others_us * US] * 3, 0)


def packing_ps(*layers: Layer) -> list[int]:
    """Of one layer what is said of a kind counts; a later layer counts for all it speaks of."""
    fixed_ps = dict.fromkeys(KINDS, 0)
    for layer in layers:
        if text := layer.get("machine.pack.fixed"):
            fixed_ps = dict.fromkeys(KINDS, int(text.split()[0]) * US)
        if text := layer.get("machine.pack.rays.fixed"):
            fixed_ps["rays"] = int(text.split()[0]) * US
    return list(fixed_ps.values())


@given(LAYER, LAYER, LAYER, st.sampled_from(["mapping", "name", "list", "none"]))
def test_what_is_said_later_counts(
    of_reading: Layer, of_file: Layer, of_set: Layer, form: str
) -> None:
    own = {"description": "drawn"} | tree(of_reading, sourced=True)
    Path("own.yaml").write_text(json.dumps(own))
    Path("c.yaml").write_text(json.dumps(as_configuration(of_file, form)))
    config = load_config("c.yaml", assignments(of_set))

    layers = (of_reading, of_file, of_set)
    rules, memory = config.settings.placement, config.memory
    assert rules.pixels == last("placement.pixels", "blocks", *layers)
    assert rules.owners == last("placement.owners", "bisection", *layers)
    assert memory.transient == last("memory.transient", 0, *layers)
    hardware = config.machine_for(64)
    assert hardware.quantum == last("machine.quantum", 64, *layers)
    assert hardware.test == costs_ps(*layers)
    # the file and --set are one configuration, in which what is said of a kind counts
    assert [c.fixed_ps for c in hardware.pack] == packing_ps(of_reading, of_file | of_set)
    first, *further = config.settings.policy
    seen = layers if form in ("mapping", "list") else (of_reading, of_set)
    for policy, said in [(first, seen), *((p, (of_reading, of_set)) for p in further)]:
        assert policy.packing == last("policy.concurrent.packing", "none", *said)
        assert policy.ask_at_least == last("policy.concurrent.ask_at_least", 32, *said)


def test_a_size_that_is_said_in_another_way_is_no_missing_one() -> None:
    reading = written(f"memory: {{fraction: {leaf('20%')}}}\n")
    assert of(reading).memory == Memory(fraction=Fraction(1, 5))
    assert of(reading, memory={"bytes": "1 MB"}).memory == Memory(bytes=1_000_000)
    swept = of(reading, sweep={"memory.bytes": ["1 MB", "2 MB"]})
    assert [c.config.memory.bytes for c in comparisons(swept)] == [1_000_000, 2_000_000]


def test_policies_that_are_only_compared_with_have_their_defaults_too() -> None:
    reading = written(f"policy: {{object: {{packing: {leaf('requests')}}}}}\n")
    config = of(reading, policy="ray")
    packs = {parameters.name: parameters.packing for parameters, _ in policies_of(config)}
    assert packs == {"object": "requests", "ray": "none", "replicated": "none"}
    (comparison,) = comparisons(config)
    assert [p.packing for p in comparison.with_reference] == ["requests", "none"]


# --- costs are for the preset that they name ---


@pytest.mark.parametrize("preset", [name for name in preset_names() if name != "t3e"])
def test_another_preset_keeps_its_own_costs(preset: str) -> None:
    with_costs = of("mixed", machine={"preset": preset}, processors=8)
    assert with_costs.machine_for(8) == machine(preset, processors=8)
    assert [line.key for line in with_costs.lines_of_reading] == [
        line.key for line in load_reading("mixed").lines if not line.key.startswith("machine.")
    ]


def test_constants_have_the_source_that_counts() -> None:
    config = of("mixed", machine={"test": {"sphere": "9 us"}, "quantum": 8})
    sources = config.machine_for(64).sources
    (of_test,) = (ln.source for ln in config.reading.lines if ln.key == "machine.t3e.test")
    assert sources["test.sphere"] == sources["quantum"] == OVERRIDDEN
    assert sources["test.cone"] == of_test
    assert sources["latency"] == machine("t3e").sources["latency"]
    assert sources.keys() == machine("t3e").sources.keys()


def test_lines_that_count_are_known() -> None:
    config = of(
        "mixed",
        placement={"pixels": "rows"},
        machine={"quantum": 16, "test": "1 us"},
        policy=[{"name": "concurrent", "packing": "all"}],
    )
    assert [line.key for line in config.lines_of_reading] == [
        "memory.transient",
        "policy.object.packing",
        "policy.concurrent.ask_at_least",
        "machine.t3e.send_startup",
        "machine.t3e.receive_startup",
        "machine.t3e.ray",
    ]


@pytest.mark.parametrize(
    ("text", "key"),
    [
        (f"memory: {leaf('{transient: 3}')}", "memory"),
        (f"placement: {{pixels: {{cells: {leaf('8')}}}}}", "placement.pixels.cells"),
        (
            f"policy: {{concurrent: {{load_info: {{refresh: {leaf('1 us')}}}}}}}",
            "policy.concurrent.load_info.refresh",
        ),
    ],
)
def test_lines_around_and_within_a_key_are_known(text: str, key: str) -> None:
    assert [line.key for line in of(written(text)).lines_of_reading] == [key]


# --- rows are known by what was resolved ---


def test_readings_can_be_swept() -> None:
    config = of("plain", sweep={"reading": ["plain", "mixed"], "memory.fraction": [0.2, 0.6]})
    plan = plan_of(config)
    assert len(plan.tasks) == len(plan.points) == 2 * 2 * 2
    assert plan.further == ("reading",)
    pixels = {c.swept["reading"]: c.config.settings.placement.pixels for c in comparisons(config)}
    assert pixels == {"plain": "blocks", "mixed": "rows"}


def test_readings_that_give_the_same_are_one_simulation() -> None:
    costs = {"test": "1 us", "ray": "500 ns", "quantum": 16}
    said = of(
        "plain",
        placement={"pixels": "rows"},
        memory={"transient": "x"},
        policy={"name": "concurrent", "packing": "all", "ask_at_least": 64},
        machine=costs,
    )
    as_read = of("mixed")
    keys_of = [[task.key for task in plan_of(config).tasks] for config in (said, as_read)]
    assert keys_of[0] == keys_of[1]
    same = written("based_on: mixed\n")
    assert plan_of(of(same)).identity == plan_of(as_read).identity
    assert plan_of(of("plain")).identity != plan_of(as_read).identity


# --- one's own ---


def test_a_file_lies_beside_the_configuration_and_beside_the_one_who_sets_it() -> None:
    for folder, pixels in (("sub", "rows"), (".", "tiles")):
        Path(folder, "r").mkdir(parents=True)
        text = f"description: d\nplacement: {{pixels: {leaf(pixels)}}}\n"
        Path(folder, "r", "own.yaml").write_text(text)
    Path("sub/c.yaml").write_text(f"scene: {SCENE}\nreading: r/own.yaml\n")
    assert load_config("sub/c.yaml").settings.placement.pixels == "rows"
    set_here = load_config("sub/c.yaml", ["reading=r/own.yaml"])
    assert set_here.settings.placement.pixels == "tiles"
    assert set_here.settings.reading == "r/own.yaml"
    swept = load_config("sub/c.yaml", ["sweep.reading=[plain, r/own.yaml]"])
    assert [c.config.settings.placement.pixels for c in comparisons(swept)] == ["blocks", "tiles"]


def test_a_reading_may_be_based_on_another() -> None:
    name = written(
        "based_on: mixed\n"
        f"memory: {{transient: {leaf('3', 'a trial')}}}\n"
        f"policy: {{concurrent: {{batch: {leaf('8')}}}, ray: {{batch: {leaf('9')}}}}}\n"
        f"machine: {{t3e: {{test: {{sphere: {leaf('7 us')}}}}}, t3d: {{ray: {leaf('1 us')}}}}}\n"
    )
    mixed, own = of("mixed"), of(name, policy=["concurrent", "ray"])
    assert own.settings.placement == mixed.settings.placement
    assert own.memory == Memory(transient=3)
    assert own.settings.policy == (
        PolicyParameters("concurrent", packing="all", ask_at_least=64, batch=8),
        PolicyParameters("ray", batch=9),
    )
    # a constant is replaced as a whole: of the kinds that it does not name the preset's stands
    assert own.machine_for(64).test == TestCost(7 * US, *[4 * US] * 3, 0)
    assert own.machine_for(64).ray_ps == mixed.machine_for(64).ray_ps
    assert own.reading.costs["t3d"].texts == {"ray": "1 us"}
    assert Line("memory.transient", "3", "a trial") in own.reading.lines


# --- what is refused ---


@pytest.mark.parametrize("name", ["nope", "mixed.yaml", "no/such.yaml", "PLAIN", "../plain"])
def test_an_unknown_reading_is_refused_with_the_names(name: str) -> None:
    Path("c.yaml").write_text(f"scene: {SCENE}\nreading: {name}\n")
    with pytest.raises(ConfigError) as refused:
        load_config("c.yaml")
    expected = f"value '{name}': expected mixed or plain, or a file .yaml that exists"
    assert str(refused.value) == f"c.yaml:2: reading: {expected}"
    with pytest.raises(ConfigError) as refused:
        config_from_mapping({"scene": SCENE}, [f"reading={name}"])
    assert str(refused.value) == f"--set reading: {expected}"


@pytest.mark.parametrize("value", [3, None, [], "", "two\nlines"])
def test_what_is_no_name_is_refused(value: object) -> None:
    with pytest.raises(ConfigError, match=r"^reading: value .*: expected a reading of the package"):
        of(value)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("placement: {pixel: LEAF}", "placement: unknown key 'pixel': did you mean 'pixels'?"),
        ("placement: {pixels: rows}", "placement.pixels: expected {value: ..., source: ...}"),
        (
            "placement: {pixels: {value: rows, range: [rows, tiles], source: s}}",
            "placement.pixels.range: expected none: machines have ranges",
        ),
        ("placement: {pixels: {value: rows}}", "placement.pixels: expected {value: ..."),
        ("placement: {pixels: {value: rows, source: ''}}", "placement.pixels: expected {value"),
        ("placement: {pixels: LEAF}", "placement.pixels: value 'v': expected blocks, rows"),
        ("placement:", "placement: expected {value: ..., source: ...}"),
        ("memory: {transient: {value: 101%, source: s}}", "memory.transient: value '101%': exp"),
        ("policy: {objct: {packing: LEAF}}", "policy: unknown key 'objct': did you mean 'obj"),
        ("policy: {packing: LEAF}", "policy: unknown key 'packing': "),
        ("policy: {ray: {packing: LEAF}}", "policy.ray.packing: value 'v': expected"),
        ("policy: {object: {packing: {value: all, source: s}}}", "policy.object.packing: value "),
        ("policy: {object: {label: LEAF}}", "policy.object.label: expected none: readings do"),
        ("policy: {object: {name: LEAF}}", "policy.object.name: expected none: readings do"),
        (
            "policy: {object: {value: {label: v}, source: s}}",
            "policy.object: label: expected none: readings",
        ),
        (
            "machine: {t3e: {value: {shape: v}, source: s}}",
            "machine.t3e: shape: expected none: readings do",
        ),
        ("placement: LEAF", "placement: value 'v': expected a mapping (key: value)"),
        ("memory: LEAF", "memory: value 'v': expected a mapping (key: value)"),
        ("policy: LEAF", "policy: value 'v': expected a mapping (key: value)"),
        ("policy: {ray: LEAF}", "policy.ray: value 'v': expected a mapping (key: value)"),
        ("machine: LEAF", "machine: value 'v': expected a mapping (key: value)"),
        ("machine: {t3e: LEAF}", "machine.t3e: value 'v': expected a mapping (key: value)"),
        ("policy: [LEAF]", "policy: expected {value: ..., source: ...}"),
        ("machine: {test: LEAF}", "machine: unknown key 'test': expected one of bluegene-l, cloud"),
        ("machine: {t3e: {test: LEAF}}", "machine.t3e.test: value 'v': expected a time"),
        ("machine: {t3e: {tests: LEAF}}", "machine.t3e: unknown key 'tests': did you mean 'test'?"),
        ("machine: {t3e: {contention: LEAF}}", "machine.t3e.contention: expected none: readings"),
        ("machine: {t3e: {preset: LEAF}}", "machine.t3e: unknown key 'preset'"),
        ("value: 3\nsource: s", "value: expected {value: ..., source: ...}"),
        ("scene: LEAF", "unknown key 'scene': expected one of machine, memory, placement, policy"),
        ("based_on: own.yaml", "based_on: value 'own.yaml': expected mixed or plain"),
        ("based_on: [plain]", "based_on: value ['plain']: expected mixed or plain"),
    ],
)
def test_a_mistake_in_a_reading_is_told_with_its_place(line: str, problem: str) -> None:
    written(line.replace("LEAF", "{value: v, source: one's own}") + "\n")
    with pytest.raises(ConfigError) as refused:
        of("own.yaml")
    message = str(refused.value)
    assert message.startswith(f"own.yaml:2: {problem}"), message
    assert "\n" not in message


@pytest.mark.parametrize(
    "text", ["", "3", "[a]", "placement: {}", "description: [a]", "description:"]
)
def test_a_file_that_is_no_reading(text: str) -> None:
    Path("own.yaml").write_text(text)
    with pytest.raises(ConfigError, match=r"^own\.yaml: expected a text description, and what"):
        of("own.yaml")


# --- what is told of defaults ---


def test_defaults_of_a_reading_are_told() -> None:
    mixed = load_reading("mixed")

    def default(name: str, value: object = None) -> str:
        return default_of(name, keys()[name].expect, value, mixed)

    assert default("placement.pixels", "blocks") == "rows (reading mixed)"
    assert default("placement.owners", "bisection") == "bisection"
    assert default("policy.ask_at_least", 32) == "32, 64 for concurrent (reading mixed)"
    assert default("policy.packing", "none") == "none, all for concurrent (reading mixed)"
    assert default("machine.ray") == "0.5 us (t3e, reading mixed)"
    assert default("machine.send_startup") == "10 us (t3e)"
    assert default("machine.latency") == "2 us (t3e)"
    assert default("memory.bytes") == "none"


def test_the_schema_names_no_default_that_is_another() -> None:
    config = config_from_mapping({"scene": SCENE})
    definitions = json_schema()["$defs"]
    pixels = definitions["PlacementRules"]["properties"]["pixels"]
    asked = definitions["PolicyParameters"]["properties"]["ask_at_least"]
    assert pixels.get("default") in (None, config.settings.placement.pixels)
    assert asked.get("default") in (None, config.settings.policy[0].ask_at_least)


def test_a_policy_may_be_set_as_another(tmp_path: Path) -> None:
    assert of("mixed", policy="holders").settings.policy[0].packing == "all"
    assert of("plain", policy="holders").settings.policy[0].packing == "none"
    text = "from simmpp.policy import Policy\nPOLICY = Policy('own', {hooks}, like='concurrent')\n"
    for hooks, packing in (
        ("send=lambda v: 1, ask=lambda v: 1", "all"),
        ("send=lambda v: 1", "none"),
    ):
        path = tmp_path / "own.py"
        path.write_text(text.replace("{hooks}", hooks))
        (policy,) = of("mixed", policy={"file": str(path)}).settings.policy
        assert (policy.packing, policy.ask_at_least) == (packing, 64)
