"""The configuration: defaults, short forms, and one line for every mistake."""

from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.errors import ConfigError
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.sweep.config import config_from_mapping, load_config
from simmpp.sweep.settings import Settings
from simmpp.workload.picture import Picture

A_SHARE = "expected a share from 0 to 1, such as 0.1, 10% or 1/64"
PRODUCT = "expected three integers whose product is processors ="


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def load(text: str, *overrides: str):  # type: ignore[no-untyped-def]
    Path("c.yaml").write_text(text, encoding="utf-8")
    return load_config("c.yaml", overrides)


def mistake(text: str, *overrides: str) -> str:
    with pytest.raises(ConfigError) as caught:
        load(text, *overrides)
    return str(caught.value)


def test_everything_but_the_scene_has_a_default() -> None:
    config = load("scene: {spd: mountain, size: 5}\n")
    assert config.scene_spec == {"spd": "mountain", "size": 5}
    assert config.picture == Picture()
    assert config.memory == Memory()
    assert config.placement_rules == PlacementRules()
    assert config.policies == (PolicyParameters("concurrent"),)
    assert config.machine_for(64).name == "t3e"
    settings = config.settings
    assert (settings.processors, settings.seeds, settings.tolerance) == (64, (0,), None)
    assert (settings.method, settings.engine) == ("simulate", "simpy")


def test_everything_can_be_said() -> None:
    config = load("""
scene: {mesh: bunny.glb, objects: {clusters: 64}}
picture: {resolution: 9, samples: corners, max_depth: 3, shadows: false, refraction: false}
machine: {preset: t3d, shape: [8, 1, 1], test: 1 us, pack: {rays: {bandwidth: unlimited}}}
processors: 8
memory: {bytes: 64 MB, residents: nearest, transient: 3}
placement: {owners: morton, pixels: tiles}
ready_order: breadth-first
policy:
  - object
  - {name: concurrent, label: eager, min_load: 100, batch: 1, ask_at_least: 2,
     load_info: {refresh: 5 ms}, merge_requests: false}
seeds: [3, 1]
tolerance: 2%
max_seeds: 9
method: analytical
sweep: {processors: [8], memory.bytes: [1 MB, 2 MB], policy: [object, [ray, concurrent]]}
""")
    assert config.scene_spec == {"mesh": "bunny.glb", "objects": {"clusters": 64}}
    assert config.picture == Picture(9, "corners", 3, shadows=False, refraction=False)
    assert config.memory == Memory(bytes=64_000_000, residents="nearest", transient=3)
    assert config.placement_rules == PlacementRules("morton", "tiles")
    assert config.machine_for(8).test.cone_ps == 1_000_000
    assert config.policies[1] == PolicyParameters(
        "concurrent", "eager", 100, 1, 2, "piggyback", 5 * 10**9, merge_requests=False
    )
    assert config.settings.tolerance == Fraction(1, 50)


@pytest.mark.parametrize(
    ("text", "spec"),
    [
        ("rings", {"spd": "rings"}),
        ("rings:3", {"spd": "rings", "size": 3}),
        ("a/b.nff", {"nff": "a/b.nff"}),
        ("b.obj", {"mesh": "b.obj"}),
        ("b.obj:nodes", {"mesh": "b.obj", "objects": "nodes"}),
        ("b.obj:9", {"mesh": "b.obj", "objects": {"clusters": 9}}),
    ],
)
def test_scene_as_text(text: str, spec: dict[str, object]) -> None:
    assert load(f"scene: {text}").scene_spec == spec


def test_scene_files_lie_beside_the_configuration(tmp_path: Path) -> None:
    folder = tmp_path / "far" / "away"
    folder.mkdir(parents=True)
    (folder / "c.yaml").write_text("scene: {nff: x.nff}")
    path = str(folder / "c.yaml")
    assert load_config(path).scene_spec == {"nff": str(folder / "x.nff")}
    assert load_config(path, ["scene=y.nff"]).scene_spec == {"nff": "y.nff"}


S = "scene: rings:1\n"
MISTAKES = [
    ("", "c.yaml: the file is empty: expected at least the key 'scene'"),
    ("# nothing", "c.yaml: the file is empty: expected at least the key 'scene'"),
    ("- a", "c.yaml: expected keys with values, such as 'scene: mountain:5'"),
    ("a: [", "c.yaml:1: broken YAML: expected the node content, but found '<stream end>'"),
    (
        S + "seeds:\n\t- 1",
        "c.yaml:3: broken YAML: found character '\\t' that cannot start any token",
    ),
    (S + S, "c.yaml:2: duplicate key 'scene', first on line 1"),
    ("processors: 8", "c.yaml:1: missing key 'scene'"),
    ("procesors: 8", "c.yaml:1: unknown key 'procesors': did you mean 'processors'?"),
    ("scene: {}", "c.yaml:1: scene: expected one of spd, nff, mesh, got none"),
    (
        "scene: {spd: rings, nff: x}",
        "c.yaml:1: scene: expected one of spd, nff, mesh, got spd and nff",
    ),
    ("scene: {nff: x, size: 1}", "c.yaml:1: scene: size goes with spd only"),
    ("scene: {spd: x}", "c.yaml:1: scene.spd: value 'x': expected balls, "),
    (
        "scene: {spd: mountain, size: 9}",
        "c.yaml:1: scene.size: value 9: the size of mountain must be",
    ),
    (S + "processors: 0", "c.yaml:2: processors: value 0: expected an integer from 1 to 65536"),
    (
        S + "processors: 1e1",
        "c.yaml:2: processors: value 10.0: expected an integer from 1 to 65536",
    ),
    (S + "processors: '8'", "c.yaml:2: processors: value '8': expected an integer from 1 to 65536"),
    (
        S + "processors: true",
        "c.yaml:2: processors: value true: expected an integer from 1 to 65536",
    ),
    (S + "processors:", "c.yaml:2: processors: value empty: expected an integer from 1 to 65536"),
    (S + "memory:\n  fraction: 1.2", f"c.yaml:3: memory.fraction: value 1.2: {A_SHARE}"),
    (S + "memory: {fraction: .nan}", f"c.yaml:2: memory.fraction: value nan: {A_SHARE}"),
    (S + "memory: {fraction: 12:30}", f"c.yaml:2: memory.fraction: value '12:30': {A_SHARE}"),
    (S + "memory: {fraction: on}", f"c.yaml:2: memory.fraction: value 'on': {A_SHARE}"),
    (
        S + "memory: {bytes: 64}",
        "c.yaml:2: memory.bytes: value 64: expected a size such as '64 MB'",
    ),
    (
        S + "memory: {bytes: 1 MB, fraction: 1}",
        "c.yaml:2: memory: expected fraction or bytes, got both",
    ),
    (
        S + "memory:\n  resident: x",
        "c.yaml:3: memory: unknown key 'resident': did you mean 'residents'?",
    ),
    (S + "memory: 3", "c.yaml:2: memory: value 3: expected a mapping (key: value)"),
    (
        S + "machine: {preset: t3x}",
        "c.yaml:2: machine.preset: value 't3x': expected bluegene-l, t3d",
    ),
    (S + "machine: {shape: [8, 4, 4]}", f"c.yaml:2: machine.shape: value [8, 4, 4]: {PRODUCT} 64"),
    (
        S + "machine: {shape: 8}",
        "c.yaml:2: machine.shape: value 8: expected three positive integers",
    ),
    (
        S + "machine: {latency: 2}",
        "c.yaml:2: machine.latency: value 2: expected a time such as '12 us'",
    ),
    (
        S + "machine: {latency: 2 MB}",
        "c.yaml:2: machine.latency: value '2 MB': expected a time such as",
    ),
    (
        S + "machine: {latency: 9e99 s}",
        "c.yaml:2: machine.latency: value '9e99 s': expected a time",
    ),
    (
        S + "machine: {test: 1}",
        "c.yaml:2: machine.test: value 1: expected a time such as '12 us', or",
    ),
    (
        S + "policy: objct",
        "c.yaml:2: policy: value 'objct': expected object, ray, concurrent or repl",
    ),
    (S + "policy: [ray, ray]", "c.yaml:2: policy: two are called 'ray': expected a label for each"),
    (
        S + "policy: {name: ray, label: object}",
        "c.yaml:2: policy: label 'object' is the name of another",
    ),
    (S + "policy: []", "c.yaml:2: policy: expected at least one policy"),
    (
        S + "policy:\n- ray\n- {batch: 0}",
        "c.yaml:4: policy[1].batch: value 0: expected an integer from",
    ),
    (S + "policy: {nam: ray}", "c.yaml:2: policy: unknown key 'nam': did you mean 'name'?"),
    (
        S + "policy: {min_load: 0.1}",
        "c.yaml:2: policy.min_load: value 0.1: expected a share of n0 / nb",
    ),
    (
        S + "policy: {load_info: {refresh: 5}}",
        "c.yaml:2: policy.load_info: value {'refresh': 5}: expe",
    ),
    (S + "seeds: []", "c.yaml:2: seeds: value []: expected a list of different integers from 0"),
    (S + "seeds: [1, 1]", "c.yaml:2: seeds: value [1, 1]: expected a list of different integers"),
    (S + "tolerance: 0", "c.yaml:2: tolerance: value 0: expected none, or a share above 0%"),
    (S + "method: magic", "c.yaml:2: method: value 'magic': expected simulate, analytical or"),
    (S + "engine: magic", "c.yaml:2: engine: value 'magic': expected "),
    (S + "sweep: 3", "c.yaml:2: sweep: value 3: expected a mapping of keys to lists"),
    (S + "sweep: {processors: 8}", "c.yaml:2: sweep: processors: value 8: expected a list of 1 to"),
    (S + "sweep: {seeds: [1]}", "c.yaml:2: sweep: 'seeds' can't be swept"),
    (S + "sweep:\n  memory.fration: [1]", "c.yaml:3: memory: unknown key 'fration': did you mean"),
    (
        S + "sweep:\n  processors: [8,\n   0]",
        "c.yaml:4: processors: value 0: expected an integer from",
    ),
    (
        S + "sweep: {machine.shape: [[4, 4, 4], [9, 1, 1]]}",
        "c.yaml:2: machine.shape: value [9, 1, 1]:",
    ),
]


@pytest.mark.parametrize(("text", "line"), MISTAKES)
def test_a_mistake_is_one_line_with_its_place(text: str, line: str) -> None:
    message = mistake(text)
    assert message.startswith(line)
    assert len(message.splitlines()) == 1


@pytest.mark.parametrize(
    ("override", "line"),
    [
        ("processors=0", "--set processors: value 0: expected an integer from 1 to 65536"),
        ("procs=8", "--set procs: unknown key 'procs': did you mean 'processors'?"),
        ("memory.x=8", "--set memory.x: memory: unknown key 'x': expected one of bytes, fraction"),
        ("processors.x=8", "--set processors.x: 'processors' has no keys of its own"),
        ("processors", "--set processors: expected KEY=VALUE, such as processors=8"),
        ("seeds=[1", "--set seeds: broken YAML: expected ',' or ']'"),
        ("machine.shape=[2, 2, 2]", f"--set machine.shape: value [2, 2, 2]: {PRODUCT} 64"),
        ("policy={nam: x}", "--set policy: unknown key 'nam': did you mean 'name'?"),
        (
            "sweep.processors=[0]",
            "--set sweep.processors: processors: value 0: expected an integer",
        ),
    ],
)
def test_a_mistake_of_set_names_set(override: str, line: str) -> None:
    assert mistake(S, override).startswith(line)


def test_set_writes_short_forms_out() -> None:
    config = load(
        S + "policy: [object, ray]\nmachine: {test: 2 us}",
        "policy.batch=7",
        "scene.size=2",
        "machine.test.sphere=1 us",
    )
    assert [(each.name, each.batch) for each in config.policies] == [("object", 7), ("ray", 7)]
    assert config.scene_spec == {"spd": "rings", "size": 2}
    test = config.machine_for(64).test
    assert (test.sphere_ps, test.cone_ps) == (1_000_000, 2_000_000)


def test_the_last_set_wins() -> None:
    assert load(S + "processors: 8", "processors=16", "processors=32").processors == 32


def test_a_shape_that_only_fits_swept_processors() -> None:
    config = load(S + "machine: {shape: [2, 2, 2]}\nsweep: {processors: [8]}")
    assert config.machine_for(8).shape == (2, 2, 2)
    with pytest.raises(ConfigError, match="product is processors = 64"):
        config.machine_for(64)


def test_python_data() -> None:
    config = config_from_mapping({"scene": "rings:1", "memory": {"fraction": Fraction(1, 3)}})
    assert config.memory.fraction == Fraction(1, 3)
    for wrong, message in [
        ({"scene": "rings:1", "processors": 0}, "processors: value 0: expected an integer"),
        ({"scene": "rings:1", 1: 2}, "expected"),
        ({"scene": object()}, "scene: value <object"),
        (3, "value 3: expected a mapping"),
    ]:
        with pytest.raises(ConfigError, match=message):
            config_from_mapping(wrong)  # type: ignore[arg-type]


VALUES = [
    "0",
    "-1",
    "1",
    "8",
    "0.1",
    "1e-6",
    "12%",
    "on",
    "null",
    "[]",
    "[1, 2]",
    "{}",
    "{a: 1}",
    "12 us",
    "object",
    "none",
    "'",
    "[[object]]",
    "&a 1",
    "*a",
    "!!int 3",
    "1e999",
    "\t",
    "|",
]
LINES = st.tuples(
    st.sampled_from(
        [*Settings.model_fields, "x", "  fraction", "  - a", "  size", "- b", "? c", ""]
    ),
    st.sampled_from([": ", ":", ":\n  ", " "]),
    st.one_of(st.sampled_from(VALUES), st.text(max_size=6)),
).map("".join)


@given(st.lists(LINES, max_size=6).map("\n".join))
def test_any_text_is_a_configuration_or_one_line(text: str) -> None:
    Path("c.yaml").write_bytes(text.encode("utf-8", "surrogatepass"))
    try:
        load_config("c.yaml")
    except ConfigError as error:
        assert len(str(error).splitlines()) == 1


PLAIN = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5)),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3)
    ),
    max_leaves=5,
)


@given(st.sampled_from(sorted(Settings.model_fields)), PLAIN)
def test_any_value_of_a_key_is_taken_or_refused(key: str, value: object) -> None:
    try:
        config_from_mapping({"scene": "rings:1", key: value})
    except ConfigError as error:
        assert len(str(error).splitlines()) == 1
