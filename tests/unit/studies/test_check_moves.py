"""What counts as moved between two sweeps, and how it is told."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from simmpp.methods.columns import COLUMNS
from simmpp.studies.check.moves import Move, Sweep, lines, moves, moves_by_measure
from simmpp.sweeps.matching import percent
from simmpp.sweeps.profits import profit_columns

TWO_PERCENT = {"time_profit": Fraction(2, 100)}


def result(**cells: Any) -> dict[str, str]:
    given = {
        "scene": "s",
        "processors": 8,
        "fraction": 0.1,
        "policy": "ray",
        "seed": 0,
        "error": "",
    }
    return {name: str((given | cells).get(name, 1)) for name in COLUMNS}


def profit(**cells: Any) -> dict[str, str]:
    given = {"scene": "s", "processors": 8, "fraction": 0.1, "policy": "ray"}
    return {name: str((given | cells).get(name, 1.0)) for name in profit_columns()}


def tables(results: list[dict[str, str]], profits: list[dict[str, str]]) -> Sweep:
    return Sweep(results, profits)


def test_equal_tables_have_no_moves_whatever_the_engine() -> None:
    old = tables([result(engine="compiled")], [profit()])
    assert moves(old, tables([result(engine="simpy")], [profit()]), {}) == []


@pytest.mark.parametrize("column", ["makespan_ps", "events", "effective_fraction", "error"])
def test_every_integer_counts(column: str) -> None:
    (move,) = moves(tables([result()], []), tables([result(**{column: 2})], []), {})
    assert (move.measure, move.now, move.of_curve) == (column, "2", False)
    assert dict(move.key)["seed"] == "0"


def test_intervals_follow_from_the_rest() -> None:
    assert moves(tables([], [profit()]), tables([], [profit(time_profit_low=2.0)]), {}) == []


@pytest.mark.parametrize(
    ("now", "moved"),
    [(1.0199, False), (0.9801, False), (1.0201, True), (0.9799, True), ("inf", True)],
)
def test_a_tolerance_is_relative(now: object, moved: bool) -> None:
    old, new = tables([], [profit(time_profit=1.0)]), tables([], [profit(time_profit=now)])
    assert bool(moves(old, new, TWO_PERCENT)) is moved
    assert moves(old, new, {}) != []


def test_with_tolerances_only_what_is_named_is_compared_and_errors() -> None:
    old = tables([result()], [profit()])
    new = tables([result(makespan_ps=5)], [profit(message_profit=9.0)])
    assert moves(old, new, TWO_PERCENT) == []
    failed = tables([result(error="timeout")], [profit()])
    assert [move.measure for move in moves(old, failed, TWO_PERCENT)] == ["error"]


def test_infinite_profits_are_equal() -> None:
    rows = [profit(message_profit="inf")]
    assert moves(tables([], rows), tables([], rows), {"message_profit": Fraction(1, 100)}) == []


@pytest.mark.parametrize("tolerances", [{}, TWO_PERCENT])
def test_points_gone_and_new(tolerances: dict[str, Fraction]) -> None:
    old = tables([result(seed=0), result(seed=1)], [profit(fraction=0.1), profit(fraction=0.2)])
    new = tables([result(seed=1), result(seed=2)], [profit(fraction=0.2), profit(fraction=0.3)])
    found = moves(old, new, tolerances)
    assert [(move.measure, move.baseline, move.now) for move in found] == [
        ("point", "there", "missing"),
        ("point", "missing", "new"),
    ] * 2
    assert [dict(move.key).get("seed") for move in found] == [None, None, "0", "2"]


def test_further_axes_are_keys() -> None:
    old = tables([result() | {"policy.batch": "1"}, result() | {"policy.batch": "2"}], [])
    new = tables([result() | {"policy.batch": "1"}, result(tests=3) | {"policy.batch": "2"}], [])
    (move,) = moves(old, new, {})
    assert dict(move.key)["policy.batch"] == "2"


def test_lines_and_summary() -> None:
    key = (("policy", "ray"),)
    found = [
        Move(key, "tests", "100", "101"),
        Move(key, "tests", "100", "90"),
        Move(key, "time_profit", "2.0", "2.1", Fraction(1, 100)),
        Move(key, "point", "there", "missing"),
    ]
    assert lines(found, 2) == [
        {"policy": "ray", "measure": "tests", "baseline": "100", "now": "90",
         "change": "-10 %", "allowed": "none"},
        {"policy": "ray", "measure": "point", "baseline": "there", "now": "missing",
         "change": "", "allowed": "none"},
    ]  # fmt: skip
    assert lines(found)[2]["allowed"] == "1 %"
    assert moves_by_measure(found)[0] == {
        "measure": "tests",
        "rows": "2",
        "from": "-10 %",
        "to": "+1 %",
    }
    assert percent(0.012345) == "+1.23 %"
    assert Move(key, "tests", "0", "5").change is None
