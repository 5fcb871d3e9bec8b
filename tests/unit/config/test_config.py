"""The configuration: defaults, short forms, and any text either read or refused."""

from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.common.errors import ConfigError
from simmpp.config.config import config_from_mapping, load_config
from simmpp.config.settings import DEFAULT_READING, Settings
from simmpp.placement.placement import Cells, Memory, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.picture import Picture


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def load(text: str, *overrides: str):  # type: ignore[no-untyped-def]
    Path("c.yaml").write_text(text, encoding="utf-8")
    return load_config("c.yaml", overrides)


def test_everything_but_the_scene_has_a_default() -> None:
    config = load("scene: {spd: mountain, size: 5}\n")
    assert config.settings.reading == DEFAULT_READING
    assert config.scene_spec == {"spd": "mountain", "size": 5}
    assert config.picture == Picture()
    assert config.memory == Memory(transient="x")
    assert config.settings.placement == PlacementRules(pixels="rows")
    concurrent = PolicyParameters("concurrent", ask_at_least=64, packing="all")
    assert config.settings.policy == (concurrent,)
    assert config.machine_for(64).name == "t3e"
    settings = config.settings
    assert (settings.processors, settings.seeds, settings.tolerance) == (64, (0,), None)
    assert (settings.method, settings.engine) == ("simulate", "compiled")


def test_everything_can_be_said() -> None:
    config = load("""
scene: {mesh: bunny.glb, objects: {clusters: 64}}
reading: plain
picture: {resolution: 9, samples: corners, max_depth: 3, shadows: false, refraction: false}
machine: {preset: t3d, shape: [8, 1, 1], test: 1 us, pack: {rays: {bandwidth: unlimited}}}
processors: 8
memory: {bytes: 64 MB, residents: nearest, transient: 5%}
placement: {owners: morton, pixels: {cells: 8}}
ready_order: breadth-first
policy:
  - object
  - {name: concurrent, label: eager, min_load: 100, batch: 1, ask_at_least: 2,
     load_info: {refresh: 5 ms}, merge_requests: false, packing: requests}
seeds: [3, 1]
tolerance: 2%
max_seeds: 9
method: analytical
sweep: {processors: [8], memory.bytes: [1 MB, 2 MB], policy: [object, [ray, concurrent]]}
""")
    assert config.scene_spec == {"mesh": "bunny.glb", "objects": {"clusters": 64}}
    assert config.picture == Picture(9, "corners", 3, shadows=False, refraction=False)
    assert config.memory == Memory(bytes=64_000_000, residents="nearest", transient=Fraction(1, 20))
    assert config.settings.placement == PlacementRules("morton", Cells(8))
    assert config.machine_for(8).test.cone_ps == 1_000_000
    assert config.settings.policy[1] == PolicyParameters(
        *("concurrent", "eager", 100, 1, 2, "piggyback", 5 * 10**9),
        merge_requests=False,
        packing="requests",
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


@pytest.mark.parametrize("value", [0, 1, "5%", "1/64", "x"])
def test_transient_memory_is_a_number_a_share_or_as_the_fraction(value: int | str) -> None:
    share = value if value in (0, 1, "x") else Fraction({"5%": "1/20"}.get(str(value), str(value)))
    assert load(S, f"memory.transient={value}").memory.transient == share
    assert load(S + f"memory: {{transient: {value}}}").memory.transient == share
    assert isinstance(load(S, "memory.transient=100%").memory.transient, Fraction)
    assert type(load(S, "memory.transient=1").memory.transient) is int


def test_pixels_are_a_word_or_the_side_of_cells() -> None:
    for text, rule in (("rows", "rows"), ("{cells: 8}", Cells(8))):
        assert load(S, f"placement.pixels={text}").settings.placement.pixels == rule
    assert PlacementRules(pixels={"cells": 8}) == PlacementRules(pixels=Cells(8))  # type: ignore[arg-type]


def test_set_writes_short_forms_out() -> None:
    config = load(
        S + "policy: [object, ray]\nmachine: {test: 2 us}",
        "policy.batch=7",
        "scene.size=2",
        "machine.test.sphere=1 us",
    )
    assert [(each.name, each.batch) for each in config.settings.policy] == [
        ("object", 7),
        ("ray", 7),
    ]
    assert config.scene_spec == {"spd": "rings", "size": 2}
    test = config.machine_for(64).test
    assert (test.sphere_ps, test.cone_ps) == (1_000_000, 2_000_000)


def test_set_takes_back_what_said_the_same_in_another_way() -> None:
    assert load(S + "memory: {fraction: 0.2}", "memory.bytes=1 MB").memory.bytes == 1_000_000
    assert load(S + "memory: {bytes: 1 MB}", "memory.fraction=1").memory.bytes is None
    config = load(S + "memory: {fraction: 0.2}\nsweep: {memory.bytes: [1 MB]}")
    assert config.memory.fraction == Fraction(1, 5)


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
