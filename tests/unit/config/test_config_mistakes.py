"""Every mistake in a configuration is one line: file, line, key, value, what was expected."""

from pathlib import Path

import pytest

from simmpp.common.errors import ConfigError
from simmpp.config.config import load_config

A_SHARE = "expected a share from 0 to 1, such as 0.1, 10% or 1/64"
A_POLICY = "expected object, ray, concurrent, replicated, holders or cost, or a mapping"
PRODUCT = "expected three integers whose product is processors ="


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def mistake(text: str, *overrides: str) -> str:
    Path("c.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        load_config("c.yaml", overrides)
    return str(caught.value)


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
    (
        "scene: {}",
        "c.yaml:1: scene: expected one of spd, nff, mesh, parts, cells, workload, got none",
    ),
    (
        "scene: {spd: rings, nff: x}",
        "c.yaml:1: scene: expected one of spd, nff, mesh, parts, cells, workload, got spd and nff",
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
    (
        S + "memory:\n  transient: 150%",
        "c.yaml:3: memory.transient: value '150%': expected a number of objects, a share of them",
    ),
    (
        S + "memory: {transient: 0.1}",
        "c.yaml:2: memory.transient: value 0.1: expected a number of objects, a share of them",
    ),
    (
        S + "placement:\n  pixels: row",
        "c.yaml:3: placement.pixels: value 'row': expected blocks, rows, tiles, interleaved, rand",
    ),
    (
        S + "placement:\n  pixels: {cells: 0}",
        "c.yaml:3: placement.pixels: cells: value 0: expected an integer from 1 to 2147483647",
    ),
    (
        S + "placement: {pixels: {cell: 8}}",
        "c.yaml:2: placement.pixels: value {'cell': 8}: expected blocks, rows,",
    ),
    (
        S + "sweep:\n  placement.pixels: [rows, {cells: 8},\n   {cells: -1}]",
        "c.yaml:4: placement.pixels: cells: value -1: expected an integer from 1",
    ),
    (S + "memory: 3", "c.yaml:2: memory: value 3: expected a mapping (key: value)"),
    (
        S + "machine: {preset: t3x}",
        "c.yaml:2: machine.preset: value 't3x': expected bluegene-l, cloud",
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
        "c.yaml:2: policy: value 'objct': expected object, ray, concurrent, replicated, holders or"
        " cost",
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
    (S + "seeds: [0, true]", "c.yaml:2: seeds: value true in the list: expected a list of differe"),
    (
        S + "seeds: [18446744073709551615]",
        "c.yaml:2: seeds: value 18446744073709551615 in the list: expected a list of different "
        "integers from 0 to 9223372036854775807,",
    ),
    (S + "policy: null", f"c.yaml:2: policy: value empty: {A_POLICY}"),
    (S + "policy: [1]", f"c.yaml:2: policy: value 1: {A_POLICY}"),
    ("scene: balls:1000000000", "c.yaml:1: scene: value 1000000000: the size of balls must be at"),
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
        ("memory.x=8", "--set memory.x: memory: unknown key 'x': expected one of buffers, bytes"),
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


def test_rays_are_no_configuration() -> None:
    with pytest.raises(ConfigError, match=r"^w\.parquet: .*`simmpp workload w\.parquet` lists"):
        load_config("w.parquet")
