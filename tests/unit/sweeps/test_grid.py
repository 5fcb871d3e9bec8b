"""Which points a configuration asks for, and which of them are one simulation."""

import re
from itertools import pairwise

import pytest

from simmpp.common.errors import ConfigError
from simmpp.config.axes import axes_of
from simmpp.config.config import config_from_mapping
from simmpp.policy.parameters import PolicyParameters
from simmpp.run.inputs import workload_of
from simmpp.run.point import make_point
from simmpp.sweeps.grid import GridPoint, further_columns, grid
from simmpp.sweeps.plan import plan_of
from simmpp.sweeps.task import canonical

BASE = {"scene": "tetra:1", "picture": {"resolution": 4}, "policy": "ray"}


def points(sweep: dict[str, object], **more: object) -> list[GridPoint]:
    return grid(config_from_mapping({**BASE, "sweep": sweep, **more}))


def named(found: list[GridPoint]) -> list[tuple[object, ...]]:
    return [
        (p.config.processors, float(p.config.memory.fraction), p.policy.title, p.seed)
        for p in found
        if p.policy.title != "object"
    ]


def test_axes_are_multiplied() -> None:
    found = points({"processors": [1, 2], "memory.fraction": [0.5, "20%"]}, seeds=[3, 4])
    assert sorted(named(found)) == [
        (nb, x, "ray", seed) for nb in (1, 2) for x in (0.2, 0.5) for seed in (3, 4)
    ]
    assert {p.policy.title for p in found} == {"object", "ray"}
    assert len(found) == 16


@pytest.mark.parametrize(
    ("memory", "problem"),
    [
        ({"fraction": 0.1}, "memory.fraction is swept twice"),
        ({"bytes": "1 kB"}, "expected memory.fraction or memory.bytes, got both"),
    ],
)
def test_a_key_inside_a_swept_value_is_not_swept_again(
    memory: dict[str, object], problem: str
) -> None:
    with pytest.raises(ConfigError, match=problem):
        points({"memory": [memory], "memory.fraction": [0.2]})
    assert len(points({"memory": [memory, {"fraction": 0.2}]})) == 4
    assert len(points({"memory": [{"residents": "hot"}], "memory.fraction": [0.2]})) == 2


@pytest.mark.parametrize(
    ("sweep", "override", "problem"),
    [
        ({"processors": [2, 3]}, "processors=9", "'processors' is swept; set sweep.processors"),
        ({"policy": ["ray"]}, "policy.batch=9", "'policy' is swept; set sweep.policy"),
        ({"memory.fraction": [0.2]}, "memory.bytes=1 kB", "expected none: memory.fraction is"),
        ({"memory.bytes": ["1 kB"]}, "memory.fraction=0.2", "expected none: memory.bytes is"),
    ],
)
def test_a_set_without_effect_is_refused(
    sweep: dict[str, object], override: str, problem: str
) -> None:
    config = config_from_mapping({**BASE, "sweep": sweep}, [override])
    with pytest.raises(ConfigError) as caught:
        plan_of(config)
    assert str(caught.value).startswith(f"--set {override.partition('=')[0]}: {problem}")


def test_a_set_that_some_points_take_is_none_without_effect() -> None:
    sweep = {"points": [{"name": "a", "processors": 2}, {"name": "b"}]}
    plan = plan_of(config_from_mapping({**BASE, "sweep": sweep}, ["processors=9"]))
    assert {each.point.config.processors for each in plan.points} == {2, 9}
    swept = {"processors": [2, 3]}
    effective = ["sweep.processors=[9]", "policy.batch=3"]
    points = plan_of(config_from_mapping({**BASE, "sweep": swept}, effective)).points
    assert {planned.point.config.processors for planned in points} == {9}
    assert {p.point.policy.batch for p in points if p.point.policy.title == "ray"} == {3}


def test_memory_in_bytes_is_not_dropped_for_a_swept_fraction() -> None:
    config = {**BASE, "memory": {"bytes": "1 kB"}, "sweep": {"memory.fraction": [0.1]}}
    with pytest.raises(ConfigError, match=r"memory.bytes: expected none: memory.fraction is swept"):
        plan_of(config_from_mapping(config))


def test_without_a_sweep_there_is_one_point() -> None:
    assert named(points({})) == [(64, 0.1, "ray", 0)]


def test_linked_keys_change_together() -> None:
    found = points({"processors, memory.fraction": [[1, 0.5], [2, 0.25]]})
    assert named(found) == [(1, 0.5, "ray", 0), (2, 0.25, "ray", 0)]


def test_named_points_have_a_column() -> None:
    sweep = {
        "points": [
            {"name": "small", "processors": 1},
            {"name": "slow net", "processors": 2, "machine.latency": "1 ms"},
        ],
        "memory.fraction": [0.5, 1],
    }
    config = config_from_mapping({**BASE, "sweep": sweep})
    assert further_columns(config) == ("point",)
    found = [p for p in grid(config) if p.policy.title == "ray"]
    assert [(p.swept["point"], p.config.processors) for p in found] == [
        ("small", 1), ("small", 1), ("slow net", 2), ("slow net", 2),
    ]  # fmt: skip
    assert found[2].config.machine_for(2).latency_ps == 10**9
    assert found[0].config.machine_for(1).latency_ps != 10**9


def test_the_reference_is_added_once_for_each_comparison() -> None:
    for sweep in ({"policy": ["ray", "concurrent"]}, {"policy": ["ray", ["object", "concurrent"]]}):
        titles = [p.policy.title for p in points(sweep)]
        assert titles == ["object", "ray", "concurrent"]


def test_keys_of_policies_are_set_in_the_policies_that_are_swept() -> None:
    found = points({"policy.batch": [1, 9], "policy": ["ray", "concurrent"]})
    assert [(p.policy.title, p.policy.batch, p.swept["policy.batch"]) for p in found] == [
        ("object", 256, 1), ("ray", 1, 1), ("concurrent", 1, 1),
        ("object", 256, 9), ("ray", 9, 9), ("concurrent", 9, 9),
    ]  # fmt: skip


def test_policies_that_differ_need_different_names() -> None:
    with pytest.raises(ConfigError, match="two policies are called 'ray'"):
        points({"policy": ["ray", {"name": "ray", "batch": 2}]})


def test_what_no_rule_reads_makes_no_other_simulation() -> None:
    for policy, tasks in (("ray", 2), ("object", 1), ("replicated", 1)):
        sweep = {"policy.batch": [1, 9]}
        plan = plan_of(config_from_mapping({**BASE, "policy": policy, "sweep": sweep}))
        assert len({each.task.key for each in plan.points if each.point.policy.name == policy}) == (
            tasks
        )
    parameters = PolicyParameters("object", "mine", min_load=3, batch=2, ask_at_least=5)
    assert canonical(parameters) == PolicyParameters("object")
    unmerged = PolicyParameters("object", merge_requests=False)
    assert canonical(unmerged) == unmerged


def test_equal_points_are_one_simulation() -> None:
    sweep = {
        "points": [
            {"name": "a", "processors": 2},
            {"name": "b", "processors": 2, "machine.shape": [2, 1, 1]},
            {"name": "c", "processors": 2, "machine.quantum": 3},
        ]
    }
    plan = plan_of(config_from_mapping({**BASE, "sweep": sweep}))
    assert len(plan.points) == 6
    assert len(plan.tasks) == 4
    replicated = {**BASE, "policy": "replicated", "sweep": {"memory.fraction": [0.1, 0.5]}}
    assert len(plan_of(config_from_mapping(replicated)).tasks) == 3


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("scene", ["tetra:1", "tetra:2"]),
        ("picture.resolution", [3, 4]),
        ("machine.send_startup", ["1 us", "2 us"]),
        ("machine.preset", ["t3e", "t3d"]),
        ("processors", [2, 3]),
        ("memory.fraction", [0.4, 0.5]),
        ("memory.bytes", ["1 kB", "2 kB"]),
        ("memory.residents", ["random", "nearest"]),
        ("memory.transient", [0, 1]),
        ("memory.transient", [1, "100%"]),
        ("memory.transient", ["5%", "x"]),
        ("placement.owners", ["bisection", "random"]),
        ("placement.pixels", ["blocks", "tiles"]),
        ("placement.pixels", ["rows", {"cells": 2}]),
        ("placement.pixels", [{"cells": 1}, {"cells": 2}]),
        ("ready_order", ["depth-first", "breadth-first"]),
    ],
)
def test_what_decides_results_makes_other_simulations(key: str, values: list[object]) -> None:
    plan = plan_of(config_from_mapping({**BASE, "sweep": {key: values}}))
    assert len(plan.tasks) == 4


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("policy.min_load", ["1%", 7]),
        ("policy.batch", [1, 2]),
        ("policy.ask_at_least", [1, 2]),
        ("policy.load_info", ["exact", "none", {"refresh": "1 ms"}]),
        ("policy.merge_requests", [True, False]),
    ],
)
def test_every_key_of_concurrent_dataflow_is_read(key: str, values: list[object]) -> None:
    config = {**BASE, "policy": "concurrent", "sweep": {key: values}}
    assert len(plan_of(config_from_mapping(config)).tasks) == len(values) + 1


def test_neighbouring_tasks_share_their_placement() -> None:
    sweep = {"policy.batch": [1, 9], "memory.fraction": [0.1, 0.5, 0.9]}
    tasks = plan_of(config_from_mapping({**BASE, "sweep": sweep, "seeds": [0, 1]})).tasks
    keys = [task.placement_key for task in tasks]
    changes = sum(a != b for a, b in pairwise(keys))
    assert changes == len(set(keys)) - 1 == 5


def test_two_scenes_of_one_name_are_refused(tmp_path) -> None:  # type: ignore[no-untyped-def]
    scene = "v\nfrom 0 0 0\nat 1 0 0\nup 0 0 1\nangle 45\nhither 1\nresolution 8 8\nl 1 1 1\n"
    files = []
    for n in (1, 2):
        (tmp_path / str(n)).mkdir()
        files.append(tmp_path / str(n) / "x.nff")
        files[-1].write_text(f"{scene}f 1 1 1 1 0 0 0 0\ns {n} 0 0 1\n")
    sweep = {"scene": [str(file) for file in files]}
    with pytest.raises(ConfigError, match="two different points are both called scene x,"):
        plan_of(config_from_mapping({**BASE, "sweep": sweep}))
    named = {"points": [{"name": str(n), "scene": str(file)} for n, file in enumerate(files)]}
    assert len(plan_of(config_from_mapping({**BASE, "sweep": named})).points) == 4


@pytest.mark.parametrize(
    ("sweep", "problem"),
    [
        ({"processors, memory.fraction": [[1]]}, "expected a list of 2 values"),
        ({"processors, memory.fraction": [3]}, "expected a list of 2 values"),
        ({"processors": [1], "processors, quantum": [[1, 1]]}, "processors is swept twice"),
        ({"memory.fraction": [1], "memory.bytes": [1]}, "expected memory.fraction or memory.bytes"),
        ({"seeds": [1]}, "'seeds' can't be swept"),
        ({"processors, seeds": [[1, 1]]}, "'seeds' can't be swept"),
        ({"engine": ["simpy"]}, "'engine' can't be swept"),
        ({"sweep.x": [1]}, "'sweep.x' can't be swept"),
        ({"points": [1]}, "expected a mapping with a name"),
        ({"points": [{"processors": 1}]}, "expected a mapping with a name"),
        ({"points": [{"name": "a"}, {"name": "a"}]}, "two are called 'a'"),
        ({"points": [{"name": "a", "procs": 1}]}, "unknown key 'procs'"),
        ({"points": []}, "expected a list of 1 to 1000 values"),
        ({"processors, ": [[1, 2]]}, "unknown key ''"),
        ({"machine.shape, processors": [[[2, 1, 1], 3]]}, "product is processors = 3"),
        ({"machine.shape": [[2, 1, 1], [4, 1, 1]], "processors": [2, 4]}, "product is processors"),
    ],
)
def test_mistakes(sweep: dict[str, object], problem: str) -> None:
    with pytest.raises(ConfigError, match=re.escape(problem)):
        points(sweep)


def test_axes_need_no_configuration() -> None:
    axes = axes_of({"processors": [1, 2]})
    assert [dict(choice.assignments) for choice in axes["processors"]] == [
        {"processors": 1}, {"processors": 2},
    ]  # fmt: skip


def test_seeds_and_refinement_need_a_tolerance() -> None:
    for more in ({"max_seeds": 9}, {"refine": True}):
        with pytest.raises(ConfigError, match="goes with a tolerance"):
            config_from_mapping({**BASE, **more})
    with pytest.raises(ConfigError, match="max_seeds is 8, and 9 seeds are given"):
        config_from_mapping({**BASE, "tolerance": "2%", "max_seeds": 8, "seeds": list(range(9))})


def test_a_placement_is_only_drawn_for_what_places() -> None:
    config = config_from_mapping({**BASE, "method": "analytical"})
    with pytest.raises(ConfigError, match="method: value 'analytical': expected simulate here"):
        make_point(config, workload_of(config))
