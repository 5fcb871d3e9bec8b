"""Errors of rungs: hand-worked, and those of methods that are exactly right or wrong."""

import math
from pathlib import Path

import numpy as np
import pytest

from simmpp.common.files import Row
from simmpp.plot.matplotlib_panels import draw
from simmpp.studies.bench.errors import CPU, bench_columns, bench_rows, rungs, seed_counts
from simmpp.studies.bench.figure import bench_panels

KEYS = ("scene", "processors", "fraction")
POINT = {"scene": "s", "processors": 8, "fraction": 0.1}


def row(policy: str, method: str, seed: int, makespan_ps: int, messages: int = 6) -> Row:
    return {
        **POINT, "policy": policy, "method": method, "seed": seed, "makespan_ps": makespan_ps,
        "messages": messages, CPU: 0.5,
    }  # fmt: skip


def simulated(makespans: list[int]) -> list[Row]:
    rows = [row("object", "simulate", seed, 120) for seed in range(len(makespans))]
    return rows + [row("ray", "simulate", seed, each) for seed, each in enumerate(makespans)]


def found(rows: list[Row], policy: str, method: str, seeds: int) -> Row:
    (one,) = [
        each
        for each in bench_rows(rows, KEYS, {"s": 2.5})
        if (each["policy"], each["method"], each["seeds"]) == (policy, method, seeds)
    ]
    assert tuple(sorted(one)) == tuple(sorted(bench_columns(KEYS)))
    return one


def test_each_seed_is_judged_by_the_others() -> None:
    makespans = [10, 20, 30, 40]
    one = found(simulated(makespans), "ray", "simulate", 1)
    # 10 against the mean 30 of the others, 20 against 80/3, 30 against 70/3, 40 against 20
    errors = [10 / 30 - 1, 20 / (80 / 3) - 1, 30 / (70 / 3) - 1, 40 / 20 - 1]
    assert one["makespan_error"] == pytest.approx(math.sqrt(sum(e * e for e in errors) / 4))
    profits = [12.0, 6.0, 4.0, 3.0]
    errors = [12 / (13 / 3) - 1, 6 / (19 / 3) - 1, 4 / 7 - 1, 3 / (22 / 3) - 1]
    assert one["time_profit_error"] == pytest.approx(math.sqrt(sum(e * e for e in errors) / 4))
    assert one["messages_error"] == one["message_profit_error"] == 0
    assert (one["groups"], one["reference_seeds"], one["trace_s"], one[CPU]) == (4, 3, 2.5, 0.5)
    error = np.std(profits, ddof=1) / 2
    assert one["time_profit_resolution"] == pytest.approx(error / np.mean(profits))


def test_groups_are_disjoint_and_take_their_time() -> None:
    makespans = [10, 20, 30, 40, 50, 60, 70, 80]
    one = found(simulated(makespans), "ray", "simulate", 2)
    pairs = [15, 35, 55, 75]
    errors = [each / ((360 - 2 * each) / 6) - 1 for each in pairs]
    assert one["makespan_error"] == pytest.approx(math.sqrt(sum(e * e for e in errors) / 4))
    assert (one["groups"], one["reference_seeds"], one[CPU]) == (4, 6, 1.0)


def test_a_model_is_judged_by_what_was_simulated_with_other_seeds() -> None:
    rows = [
        *simulated([99, 20, 20, 20]),
        row("object", "analytical", 0, 60),
        row("ray", "analytical", 0, 30, messages=12),
    ]
    ray = found(rows, "ray", "analytical", 1)
    assert ray["makespan_error"] == pytest.approx(0.5)  # not against seed 0, which took 99
    assert ray["messages_error"] == pytest.approx(1.0)
    assert ray["time_profit_error"] == pytest.approx(abs(2 / 6 - 1))
    assert ray["message_profit_error"] == pytest.approx(0.5)
    object_row = found(rows, "object", "analytical", 1)
    assert object_row["makespan_error"] == pytest.approx(0.5)
    assert object_row["time_profit_error"] == object_row["message_profit_error"] == ""


def test_nothing_is_right_for_nothing_only() -> None:
    rows = [row(p, "simulate", s, 9, messages=0) for p in ("object", "ray") for s in range(4)]
    rows += [row(p, "analytical", 0, 9, messages=n) for p, n in (("object", 0), ("ray", 7))]
    assert found(rows, "object", "analytical", 1)["messages_error"] == 0
    assert found(rows, "ray", "analytical", 1)["messages_error"] == ""
    assert found(rows, "ray", "analytical", 1)["message_profit_error"] == 1
    assert found(rows, "ray", "simulate", 1)["message_profit_resolution"] == 0


def test_seeds_double_up_to_a_quarter() -> None:
    assert seed_counts("simulate", 64) == [1, 2, 4, 8, 16]
    assert seed_counts("simulate", 63) == [1, 2, 4, 8]
    assert seed_counts("simulate", 4) == [1]
    assert seed_counts("analytical", 64) == [1]


def test_errors_of_the_mean_fall_with_the_root_of_the_seeds() -> None:
    random = np.random.default_rng(1)
    makespans = (10**9 * (1 + 0.1 * random.standard_normal(256))).astype(int).tolist()
    errors = [found(simulated(makespans), "ray", "simulate", n)["makespan_error"] for n in (1, 16)]
    assert errors[0] == pytest.approx(0.1, rel=0.1)
    assert errors[1] == pytest.approx(0.1 / 4, rel=0.4)


def test_a_rung_of_a_scene_and_its_figure(tmp_path: Path) -> None:
    rows = bench_rows(
        [*simulated([10, 20, 30, 40]), row("object", "analytical", 0, 60),
         row("ray", "analytical", 0, 30)], KEYS, {},
    )  # fmt: skip
    simulation, model = rungs(rows, KEYS)
    assert (simulation.method, simulation.seeds, simulation.seconds) == ("simulate", 1, 1.0)
    of_ray = next(each for each in rows if each["policy"] == "ray")
    assert simulation.error["time_profit"] == of_ray["time_profit_error"]
    of_object = next(each for each in rows if each["policy"] == "object")
    both = (of_ray["makespan_error"], of_object["makespan_error"])
    assert simulation.error["makespan"] == pytest.approx(math.hypot(*both) / math.sqrt(2))
    assert simulation.worst["makespan"] == max(both)
    assert model.method == "analytical"
    panels = bench_panels([simulation, model], {"s": "Scene"}, 4)
    assert [panel.title for panel in panels] == [
        "Error of the time profit", "Error of the message profit",
    ]  # fmt: skip
    assert {curve.label for curve in panels[0].curves} == {"Scene"}
    one, other = (
        [path.read_bytes() for path in draw(panels, tmp_path / name)] for name in ("a", "b")
    )
    assert one == other
