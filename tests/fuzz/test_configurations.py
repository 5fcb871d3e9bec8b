"""Any YAML and any ``--set`` is a configuration that runs, or one line that says what is wrong."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fuzzing import answered, changed_words, damaged, examples, mutated, written
from hypothesis import given
from hypothesis import strategies as st

from simmpp.common.errors import ConfigError
from simmpp.config.config import Config, load_config
from simmpp.workload.picture import OWN

# ruff: noqa: E501, RUF001, SIM905
NUMBERS = st.sampled_from(
    "0 1 2 3 7 64 -1 0.5 1.5 -0.1 1e-6 1e300 1e999 -1e999 .inf -.inf .nan nan inf 5e-324 1e-400 "
    "0x10 0o7 1_000 65536 65537 2147483647 2147483648 9223372036854775807 9223372036854775808 "
    "18446744073709551616 999999999999999999999999999999 1e20 12% 1/64 1/0 100% 101% 0% 1e-30%".split()
)
QUANTITIES = st.sampled_from(
    [
        "12 us", "0 s", "10 s", "11 s", "1e99 s", "-1 us", "1 us us", "us", "5e-324 s", "nan s", "inf s",
        "1 ps", "0.4 ps", "64 MB", "1 TB", "1e30 B", "0.5 B", "340 MB/s", "1 B/s", "0 MB/s", "unlimited",
        "1 kB/s", "9e15 B/s", "1 MB/us", "1e-300 s", "1 fs", "1 barn", "12 µs", "１２ us", "1e1e1 s",
    ]
)  # fmt: skip
WORDS = st.sampled_from(
    [
        "true", "false", "null", "~", "''", '""', "none", "on", "no", "object", "ray", "concurrent",
        "replicated", "piggyback", "exact", "random", "nearest", "hot", "bisection", "simpy", "compiled",
        "tetra:1", "tetra:999999999999", "rings", "tetra:-1", "mountain:x", "x.nff", "/", ".", "/dev/null",
        "a.parquet", "w.npz", "\"\\0\"", "\"\\n\"", "\"\\u2028\"", "é", "💥", "&a 1", "*a", "!!int 3", "!x y",
        "? a", "- a", "[", "]", "{", "}", "a: b: c", "|", ">", "# x", "'", "%YAML 1.1", "---", "...", "\t",
        "[]", "{}", "[[]]", "{a: 1}", "[1, 1]", "[0, 1]", "[1, 1, 4]", "{refresh: 5 ms}", "{clusters: 3}",
        "{cells: 3}", "{cells: 0}", "x", "rows", "5%", "plain", "mixed", "c.yaml", "no.yaml",
    ]
)  # fmt: skip
KEYS = st.sampled_from(
    [
        "scene", "spd", "size", "nff", "mesh", "objects", "workload", "picture", "resolution", "samples",
        "max_depth", "shadows", "machine", "preset", "shape", "test", "quantum", "pack", "fixed", "rays",
        "latency", "header_bytes", "processors", "memory", "fraction", "bytes", "residents", "transient",
        "placement", "owners", "pixels", "policy", "name", "label", "min_load", "batch", "ask_at_least",
        "load_info", "refresh", "merge_requests", "seeds", "tolerance", "max_seeds", "method", "engine",
        "sweep", "points", "check", "time_profit", "memory.fraction", "machine.test.sphere", "ready_order", "reading",
    ]
)  # fmt: skip
TOKENS = NUMBERS | QUANTITIES | WORDS | KEYS
TREES = st.recursive(
    TOKENS,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.lists(st.tuples(KEYS | TOKENS, inner), max_size=3).map(tuple)
    ),
    max_leaves=6,
)

BASES: list[Any] = [
    (("scene", "tetra:1"), ("picture", (("resolution", "3"),)), ("processors", "4")),
    (
        ("scene", (("spd", "tetra"), ("size", "1"))),
        ("picture", (("resolution", "3"), ("samples", "corners"), ("max_depth", "2"))),
        ("machine", (("preset", "t3e"), ("shape", ["2", "2", "1"]), ("latency", "3 us"))),
        ("processors", "4"),
        ("memory", (("fraction", "0.5"), ("residents", "hot"), ("transient", "2"))),
        ("placement", (("owners", "morton"), ("pixels", "tiles"))),
        ("ready_order", "breadth-first"),
        ("policy", ["object", (("name", "concurrent"), ("label", "eager"), ("min_load", "12%"))]),
        ("seeds", ["0", "3"]),
    ),
    (
        ("scene", "tetra:1"),
        ("picture", (("resolution", "2"),)),
        ("processors", "2"),
        ("memory", (("bytes", "1 MB"),)),
        ("machine", (("test", (("sphere", "1 us"), ("per_triangle", "2 ns"))),
                     ("pack", (("fixed", "1 us"), ("rays", (("bandwidth", "unlimited"),)))))),
        ("policy", (("name", "ray"), ("batch", "3"), ("load_info", (("refresh", "5 ms"),)))),
        ("sweep", (("processors", ["2", "3"]), ("memory.fraction", ["0.1", "1"]))),
    ),
]  # fmt: skip
SETS = st.sampled_from(
    [
        "scene", "scene.size", "picture.resolution", "picture.max_depth", "processors", "memory.fraction",
        "memory.bytes", "memory.transient", "machine.latency", "machine.test", "machine.test.sphere",
        "machine.shape", "machine.pack.rays.bandwidth", "machine.quantum", "policy", "policy.batch",
        "policy.min_load", "policy.load_info", "seeds", "engine", "method", "sweep", "sweep.processors",
        "check.time_profit", "tolerance", "ready_order", "placement.owners", "placement.pixels", "reading",
        "sweep.reading", "scene.camera", "scene.camera.angle", "scene.camera.eye", "scene.lights", "scene.up",
        "scene.parts", "scene.objects",
    ]
)  # fmt: skip


def small(config: Config) -> bool:
    """What runs in an instant; more is an honest request, which nobody waits for here."""
    spec, picture = config.scene_spec, config.picture
    generated = spec.get("spd") is None or (
        spec["spd"] in ("tetra", "rings", "ring") and spec.get("size", 9) in (1, 2)
    )
    own = picture.resolution == OWN  # which is 512 x 512 in the SPD
    return generated and not own and max(picture.pixels) <= 9 and config.processors <= 100


def runs_or_is_refused(*overrides: str) -> None:
    sets = [part for override in overrides for part in ("--set", override)]
    try:
        config = load_config("c.yaml", overrides)
    except ConfigError:
        assert answered("run", "c.yaml", *sets).exit_code == 2
    else:
        if small(config):
            answered("run", "c.yaml", *sets)


@examples(60)
@given(data=st.data())
def test_configurations_with_something_changed(data: st.DataObject) -> None:
    tree = data.draw(st.sampled_from(BASES))
    for _ in range(data.draw(st.integers(1, 3))):
        tree = mutated(data, tree, TREES)
    Path("c.yaml").write_text(written(tree), encoding="utf-8")
    runs_or_is_refused()


@examples(40)
@given(data=st.data())
def test_any_bytes_for_a_configuration(data: st.DataObject) -> None:
    content = written(data.draw(st.sampled_from(BASES))).encode()
    if data.draw(st.booleans()):
        content = changed_words(data, content.decode().split(" "), TOKENS).encode()
    Path("c.yaml").write_bytes(damaged(data, content))
    runs_or_is_refused()


@examples(40)
@given(key=SETS | KEYS | st.text(max_size=8), value=TREES.map(written) | st.text(max_size=8))
def test_any_override(key: str, value: str) -> None:
    Path("c.yaml").write_text(written(BASES[1]))
    runs_or_is_refused(f"{key}={value}")


READING = (
    ("description", "one"),
    ("based_on", "mixed"),
    ("placement", (("pixels", (("value", "tiles"), ("source", "one"))),)),
    ("policy", (("object", (("batch", (("value", "3"), ("source", "one"))),)),)),
    (
        "machine",
        (("t3e", (("pack", (("rays", (("fixed", (("value", "1 us"), ("source", "one"))),)),)),)),),
    ),
)  # fmt: skip


@examples(60)
@given(data=st.data())
def test_readings_with_something_changed(data: st.DataObject) -> None:
    tree: Any = READING
    for _ in range(data.draw(st.integers(0, 3))):
        tree = mutated(data, tree, TREES | st.sampled_from(READING).map(lambda pair: (pair,)))
    Path("own.yaml").write_bytes(damaged(data, written(tree).encode(), most=1))
    Path("c.yaml").write_text(written(BASES[0]))
    runs_or_is_refused("reading=own.yaml")
