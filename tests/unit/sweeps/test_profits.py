"""Profits of rows: ratios seed by seed, Student's interval, what is missing."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from simmpp.common.files import Row
from simmpp.sweeps.intervals import interval
from simmpp.sweeps.profits import best_policy, profit_columns, profit_rows


def row(policy: str, seed: int, makespan_ps: int, messages: int, **more: object) -> Row:
    return {
        "scene": "s", "processors": 4, "fraction": 0.1, "effective_fraction": 0.25,
        "policy": policy, "seed": seed, "makespan_ps": makespan_ps, "messages": messages,
        "compute_ps": 1200, "error": "", **more,
    }  # fmt: skip


def of(policy: str, rows: list[Row], further: tuple[str, ...] = ()) -> Row:
    (found,) = [each for each in profit_rows(rows, further) if each["policy"] == policy]
    return found


def test_ratios_are_taken_seed_by_seed() -> None:
    rows = [
        row("object", 0, 1000, 60), row("object", 1, 900, 50),
        row("ray", 0, 500, 20), row("ray", 1, 300, 10),
    ]  # fmt: skip
    ray = of("ray", rows)
    assert tuple(ray) == profit_columns()
    assert (ray["n"], ray["time_profit"], ray["message_profit"]) == (2, 2.5, 4.0)
    assert (ray["time_profit_min"], ray["time_profit_max"]) == (2.0, 3.0)
    # t(0.975, 1) = 12.706; deviation of 2 and 3 is 0.7071, of their mean 0.5
    assert ray["time_profit_low"] == pytest.approx(2.5 - 12.7062 * 0.5, abs=1e-4)
    assert ray["time_profit_high"] == pytest.approx(2.5 + 12.7062 * 0.5, abs=1e-4)
    assert ray["speedup"] == (1200 / 500 + 1200 / 300) / 2
    assert ray["efficiency"] == ray["speedup"] / 4
    assert of("object", rows)["time_profit"] == 1.0


def test_where_speeds_differ_efficiency_is_that_of_the_bound() -> None:
    # 4 PEs with speeds of 6 in all: 1200 of work in 600, of which the bound is 200
    uneven = {"compute_ps": 1500, "launch_ps": 0, "work_ps": 1200, "bound_ps": 200}
    ray = of("ray", [row("object", 0, 1000, 9, **uneven), row("ray", 0, 600, 9, **uneven)])
    assert (ray["speedup"], ray["efficiency"]) == (2.0, 1 / 3)
    even = {"compute_ps": 1500, "launch_ps": 300, "work_ps": 1200, "bound_ps": 300}
    ray = of("ray", [row("object", 0, 1000, 9, **even), row("ray", 0, 600, 9, **even)])
    assert (ray["speedup"], ray["efficiency"]) == (2.0, 0.5)


def test_one_seed_has_no_interval() -> None:
    ray = of("ray", [row("object", 0, 10, 0), row("ray", 0, 5, 0)])
    assert (ray["n"], ray["time_profit"], ray["message_profit"]) == (1, 2.0, 1.0)
    assert (ray["time_profit_low"], ray["time_profit_high"]) == ("", "")


def test_something_over_nothing_is_infinite() -> None:
    rows = [row(p, s, 5, n) for s in (0, 1) for p, n in (("object", 7), ("ray", 0))]
    ray = of("ray", rows)
    assert ray["message_profit"] == ray["message_profit_max"] == math.inf
    assert ray["message_profit_low"] == ""


def test_a_failed_seed_does_not_count() -> None:
    rows = [
        row("object", 0, 10, 1), row("object", 1, "", "", error="x", effective_fraction=""),
        row("object", 2, 30, 1), row("ray", 0, 5, 1), row("ray", 1, 5, 1),
        row("ray", 2, "", "", error="y", effective_fraction=""),
    ]  # fmt: skip
    assert (of("ray", rows)["n"], of("ray", rows)["time_profit"]) == (1, 2.0)
    alone = of("ray", [row("ray", 0, 5, 1)])
    assert (alone["n"], alone["time_profit"], alone["speedup"]) == (0, "", "")


def test_further_columns_keep_points_apart() -> None:
    rows = [
        row(policy, 0, time, 1, latency=latency)
        for latency, times in (("1 us", (10, 5)), ("2 us", (30, 10)))
        for policy, time in zip(("object", "ray"), times, strict=True)
    ]
    found = [each for each in profit_rows(rows, ("latency",)) if each["policy"] == "ray"]
    profits = [(each["latency"], each["time_profit"]) for each in found]
    assert profits == [("1 us", 2.0), ("2 us", 3.0)]


@given(st.lists(st.integers(1, 10**6), min_size=2, max_size=12, unique=True))
def test_the_interval_is_students(numbers: list[int]) -> None:
    values = [number / 1000 for number in numbers]
    scale = stats.sem(values)
    expected = stats.t.interval(0.95, len(values) - 1, sum(values) / len(values), scale)
    assert interval(values) == pytest.approx(expected)


def test_the_interval_holds_the_mean_19_times_of_20() -> None:
    draws = stats.norm.rvs(size=(4000, 5), random_state=7)
    held = sum(low <= 0 <= high for low, high in map(interval, draws.tolist()))  # type: ignore[misc]
    assert held / 4000 == pytest.approx(0.95, abs=0.015)


def test_best_policy_so_far() -> None:
    rows = [row("object", 0, 10, 1), row("ray", 0, 5, 1), row("concurrent", 0, 4, 1)]
    assert best_policy(rows) == ("concurrent", pytest.approx(2.5))
    assert best_policy([*rows, row("replicated", 0, 1, 0)]) == best_policy(rows)  # no dataflow
    assert best_policy([rows[0], row("ray", 0, 20, 1)]) == ("object", 1)
    begun = [
        *rows,
        row("object", 1, 10, 1),
        row("ray", 1, 1, 1),
    ]  # of concurrent, seed 1 is missing
    assert best_policy(begun) == best_policy(rows)
    assert best_policy([*begun, row("concurrent", 1, 9, 1)]) == ("ray", pytest.approx(20**0.5))
    assert best_policy(rows[1:]) is None
    assert best_policy([]) is None
