"""A folder grows: what a sweep finds there it takes, and its tables are those of a fresh folder."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mesh_files import SQUARE, U, obj

from simmpp.common.cache import cache_folder
from simmpp.common.errors import ConfigError
from simmpp.sweeps.executors import Pool, SerialExecutor
from simmpp.sweeps.journal import FILE
from simmpp.sweeps.sweep import run_sweep
from simmpp.sweeps.worker import run_task

TABLES = ("results.csv", "results.parquet", "profits.csv", "run.json")
EAGER = {"name": "concurrent", "label": "eager", "min_load": "5%"}
SMALL: dict[str, Any] = {
    "scene": "tetra:2",
    "reading": "plain",
    "picture": {"resolution": 12},
    "seeds": [0, 1],
    "policy": ["ray", "concurrent"],
    "processors": 4,
    "sweep": {"processors": [2, 4], "memory.fraction": [0.3, 1]},
}
NAMED = {"name": "slow", "machine.latency": "1 ms"}
LARGER: dict[str, dict[str, Any]] = {
    "seeds": {"seeds": [0, 1, 2, 3]},
    "another value": {"sweep": {"processors": [2, 4, 8], "memory.fraction": [0.3, 0.6, 1]}},
    "another policy": {"policy": ["ray", "concurrent", EAGER]},
    "another axis": {"sweep": {**SMALL["sweep"], "machine.latency": ["1 us", "1 ms"]}},
    "named points": {"sweep": {**SMALL["sweep"], "points": [{"name": "as it is"}, NAMED]}},
    "linked keys": {
        "sweep": {"processors, memory.fraction": [[2, 0.3], [4, 0.3], [8, 0.1]]},
    },
    "methods": {
        "sweep": {
            **SMALL["sweep"],
            "method, policy": [["simulate", ["ray", "concurrent"]], ["analytical", "ray"]],
        }
    },
    "another scene": {"sweep": {**SMALL["sweep"], "scene": ["tetra:2", "tetra:1"]}},
    "an axis less": {"sweep": {"memory.fraction": [0.1, 0.3, 1]}},
    "a tolerance": {"tolerance": "20%", "max_seeds": 12},
    "refined": {
        **{"tolerance": "20%", "max_seeds": 12, "refine": True},
        "sweep": {"memory.fraction": [0.2, 0.3, 1]},
    },
    "everything": {
        "seeds": [3, 0, 1],
        "policy": [EAGER, "ray"],
        "sweep": {"processors": [4, 3], "memory.fraction": [0.3, 0.5]},
    },
}


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("NUMBA_CACHE_DIR", str(cache_folder() / "compiled"))
        folder = tmp_path_factory.mktemp("cache")
        patch.setenv("SIMMPP_CACHE", str(folder))
        yield folder


def tables(config: Mapping[str, object], out: Path, **options: Any) -> dict[str, bytes]:
    run_sweep(config, out=out, **options)
    return {name: (out / name).read_bytes() for name in TABLES}


def counting(ran: list[str]) -> Pool:
    return Pool(SerialExecutor(), 1, lambda task: ran.append(task.key) or run_task(task))  # type: ignore[func-returns-value]


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory, cache: Path) -> Path:
    out = tmp_path_factory.mktemp("small")
    tables(SMALL, out)
    return out


def keys(out: Path) -> set[str]:
    """The simulations of a folder's journal."""
    lines = map(json.loads, (out / FILE).read_text().splitlines())
    return {line["key"] for line in lines if "key" in line}


@pytest.mark.parametrize("name", LARGER)
def test_it_is_as_if_made_at_once(small: Path, tmp_path: Path, name: str) -> None:
    """Grown, grown by two workers, and grown after a kill that left any part of the journal."""
    larger = {**SMALL, **LARGER[name]}
    expected = tables(larger, tmp_path / "fresh")
    journal = (small / FILE).read_bytes()
    for out in ("grown", "by two"):
        (tmp_path / out).mkdir()
        (tmp_path / out / FILE).write_bytes(journal)
    ran: list[str] = []
    assert tables(larger, tmp_path / "grown", pool=counting(ran)) == expected
    assert sorted(ran) == sorted(keys(tmp_path / "fresh") - keys(small)), "only what is missing"
    assert tables(larger, tmp_path / "by two", workers=2) == expected
    whole = (tmp_path / "grown" / FILE).read_bytes()
    for length in (len(journal) // 2, (len(journal) + len(whole)) // 2):
        (tmp_path / "grown" / FILE).write_bytes(whole[:length])
        assert tables(larger, tmp_path / "grown") == expected


def test_a_smaller_sweep_has_its_own_tables_and_loses_nothing(tmp_path: Path) -> None:
    larger = {**SMALL, **LARGER["everything"], "seeds": [0, 1, 2, 3]}
    expected = tables(larger, tmp_path)
    fewer = {**larger, "seeds": [1], "policy": "ray", "sweep": {"memory.fraction": [0.5]}}
    ran: list[str] = []
    assert tables(fewer, tmp_path, pool=counting(ran)) == tables(fewer, tmp_path / "fresh")
    assert tables(larger, tmp_path, pool=counting(ran)) == expected
    assert ran == []


@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(st.sampled_from(list(LARGER)), min_size=2, max_size=5))
def test_in_whatever_order_it_grew(
    tmp_path_factory: pytest.TempPathFactory, steps: list[str]
) -> None:
    out = tmp_path_factory.mktemp("steps")
    for name in steps:
        found = tables({**SMALL, **LARGER[name]}, out)
    alone = tmp_path_factory.mktemp("alone")
    assert found == tables({**SMALL, **LARGER[steps[-1]]}, alone)


@pytest.mark.parametrize(
    ("key", "first", "more"),
    [
        ("policy.batch", [64], [256, 512]),
        ("reading", ["plain"], ["mixed"]),
        ("scene.up", ["y"], ["z"]),
    ],
)
def test_new_values_of_what_names_do_not_tell(
    tmp_path: Path, key: str, first: list[Any], more: list[Any]
) -> None:
    """A policy with another number has the same name; the swept key tells which it is."""
    base = {name: said for name, said in SMALL.items() if name not in (key, "sweep")}
    if key == "scene.up":
        (tmp_path / "a.obj").write_bytes(obj(SQUARE, [range(4)]))
        base["scene"] = {"mesh": str(tmp_path / "a.obj")}
    tables({**base, "sweep": {key: first}}, tmp_path / "grown")
    larger = {**base, "sweep": {key: more}}
    assert tables(larger, tmp_path / "grown") == tables(larger, tmp_path / "fresh")


@pytest.mark.parametrize(
    ("other", "problem"),
    [
        ({"scene": "tetra:1"}, "config.scene.size is 2 there, 1 now"),
        ({"picture": {"resolution": 16}}, "config.picture.resolution is "),
        ({"machine": {"latency": "1 ms"}}, "config.machine.latency is not given there, 1 ms now"),
        ({"ready_order": "breadth-first"}, "config.ready_order is "),
        ({"reading": "mixed"}, "config."),
        ({"engine": "simpy"}, "config.engine is compiled there, simpy now"),
    ],
)
def test_what_no_axis_changes_is_refused(
    small: Path, other: dict[str, object], problem: str
) -> None:
    before = (small / FILE).read_bytes()
    with pytest.raises(ConfigError) as error:
        run_sweep({**SMALL, **other}, out=small)
    assert f"holds results of another sweep ({problem}" in str(error.value)
    assert "\n" not in str(error.value)
    assert (small / FILE).read_bytes() == before


def test_a_name_that_means_something_else_is_refused(tmp_path: Path) -> None:
    named = {**SMALL, "policy": [EAGER], "sweep": {"points": [NAMED]}}
    tables(named, tmp_path)
    for other, problem in (
        ({"policy": [EAGER | {"min_load": "9%"}]}, r"policy eager .*min_load is 1/20 there, 9/100"),
        ({"sweep": {"points": [NAMED | {"machine.latency": "2 ms"}]}}, "point slow.machine.latenc"),
    ):
        with pytest.raises(ConfigError, match=problem):
            run_sweep({**named, **other}, out=tmp_path)


def test_settings_that_give_another_machine_are_refused(tmp_path: Path) -> None:
    """The file of a reading says what tests cost where the configuration does not."""
    own = tmp_path / "own.yaml"
    cost = "description: d\nmachine: {{t3e: {{test: {{value: {} us, source: ESTIMATE}}}}}}\n"
    config = {**SMALL, "reading": str(own)}
    own.write_text(cost.format(3))
    tables(config, tmp_path / "o")
    tables({**config, "sweep": {"processors": [8]}}, tmp_path / "o")
    own.write_text(cost.format(4))
    with pytest.raises(ConfigError, match=r"machine of 2 PEs .*\.test\.\w+ is 3000000 there, 4"):
        run_sweep(config, out=tmp_path / "o")


def test_a_policy_of_ones_own_that_became_another_is_refused(tmp_path: Path) -> None:
    own = tmp_path / "own.py"
    rule = "from simmpp.policy import Policy, hook\n@hook\ndef send(v):\n    return v.load > {}\n"
    rule += "@hook\ndef ask(v):\n    return True\nPOLICY = Policy('own', send=send, ask=ask)\n"
    config = {**SMALL, "policy": {"file": str(own), "label": "mine"}}
    own.write_text(rule.format(3))
    tables(config, tmp_path / "o")
    tables({**config, "seeds": [2]}, tmp_path / "o")
    own.write_text(rule.format(4))
    with pytest.raises(ConfigError, match=r"policy mine\.file is "):
        run_sweep(config, out=tmp_path / "o")


def test_a_scene_that_became_another_is_refused(tmp_path: Path) -> None:
    config = {**SMALL, "scene": str(tmp_path / "s.obj")}
    sizes = {"seeds": [0], "sweep": {"picture.resolution": [8]}}
    (tmp_path / "s.obj").write_bytes(obj(SQUARE, [(0, 1, 2, 3)]))
    tables({**config, **sizes}, tmp_path / "o")
    tables({**config, **sizes, "sweep": {"picture.resolution": [9]}}, tmp_path / "o")
    (tmp_path / "s.obj").write_bytes(obj(U, [range(8)]))
    with pytest.raises(
        ConfigError, match=r"rays of s.obj:components \(picture [0-9a-f]{8}\) are others"
    ):
        run_sweep({**config, **sizes}, out=tmp_path / "o")
