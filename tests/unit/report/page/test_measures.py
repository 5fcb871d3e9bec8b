"""What curves show of a point: by hand, and by Student's table."""

from __future__ import annotations

import math
from statistics import stdev

import pytest
from sweep_rows import row, sweep, timed

from simmpp.common.files import Row
from simmpp.plot.curves import Panel, Spread
from simmpp.report.page.figures.profit_figures import ProfitData, profit_figures
from simmpp.report.page.measures import ALL
from simmpp.sweeps.stopping import CORRECTED
from simmpp.sweeps.winners.points import Points, points_of, points_of_profits

T_2, T_1 = 4.302652729911275, 12.706204736174698
"""Student's t of 97.5 % with 2 and with 1 degrees of freedom (any table)."""


def spread(points: Points, name: str, policy: str = "ray") -> Spread | None:
    (number,) = (n for n, profit in enumerate(points.profits) if profit["policy"] == policy)
    return ALL[name].spread(points, number)


def test_an_interval_is_that_of_the_logarithms() -> None:
    """The plain one of 0.25 and 9 reaches far below 0."""
    points = points_of(timed("object", 100, 900) + timed("ray", 400, 100), ())
    mean, half = math.sqrt(0.25 * 9), T_1 * stdev([math.log(0.25), math.log(9)]) / math.sqrt(2)
    found = spread(points, "time_profit")
    assert found == pytest.approx((mean, mean / math.exp(half), mean * math.exp(half)))
    assert points.profits[1]["time_profit_low"] < 0 < found.low


def test_intervals_of_reciprocals_are_reciprocal() -> None:
    rows = timed("object", 300, 500, 400) + timed("ray", 100, 250, 200)
    swapped = timed("ray", 300, 500, 400) + timed("object", 100, 250, 200)
    found, other = (spread(points_of(of, ()), "time_profit") for of in (rows, swapped))
    assert found is not None and other is not None
    assert found == pytest.approx((1 / other.mean, 1 / other.high, 1 / other.low))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("makespan", 200),
        ("speedup", 10),
        ("efficiency", 2.5),
        ("node_seconds", 800),
        ("peak_bytes", 30),
        ("time_profit", 3),
        ("message_profit", 5),
    ],
)
def test_each_measure_by_hand(name: str, expected: float) -> None:
    cells = {"processors": 4, "compute_ps": 2000, "peak_bytes": 30}
    rows = [
        row("object", makespan_ps=600, messages=50, **cells),
        row("ray", makespan_ps=200, messages=10, **cells),
    ]
    assert spread(points_of(rows, ()), name) == pytest.approx((expected,) * 3)


def test_what_is_infinite_or_not_known_is_not_drawn() -> None:
    rows = [row("object", messages=5), row("ray", messages=0, peak_bytes="")]
    points = points_of(rows, ())
    assert spread(points, "message_profit") is None
    assert spread(points, "peak_bytes") is None
    assert spread(points_of([row("ray")], ()), "time_profit") is None  # no reference


def test_seeds_chosen_by_their_values_have_wider_intervals() -> None:
    rows = timed("object", 300, 500, 400) + timed("ray", 100, 250, 200)
    plain, corrected = points_of(rows, ()), points_of(rows, (), confidence=CORRECTED)
    one, other = spread(plain, "time_profit"), spread(corrected, "time_profit")
    assert one is not None and other is not None
    assert other.low < one.low < one.high < other.high


def test_draws_that_are_equal_by_luck_are_as_sure_as_is_written() -> None:
    rows = timed("object", 300, 300) + timed("ray", 100, 100)
    known = points_of(rows, ()).profits
    written = [dict(profit, time_profit_low=2.9, time_profit_high=3.1) for profit in known]
    assert spread(points_of(rows, (), written), "time_profit") == (3, 2.9, 3.1)


def test_profits_alone_have_their_means() -> None:
    points = points_of(timed("object", 100, 900) + timed("ray", 400, 100), ())
    alone = points_of_profits(points.profits, ())
    assert spread(alone, "time_profit") == (4.625,) * 3
    assert spread(alone, "makespan") is None


def panels(rows: list[Row], stem: str) -> list[Panel]:
    (figure,) = (f for f in profit_figures(ProfitData(points_of(rows, ()))) if f.stem == stem)
    return [panel for of in figure.plates.values() for panel in of if isinstance(panel, Panel)]


def test_a_wide_interval_does_not_switch_the_axis_of_a_plate() -> None:
    rows = [
        each
        for x, of_ray in ((0.1, (1, 2)), (0.5, (10, 11)), (1.0, (100, 1)))
        for each in (*timed("object", 100, 100, fraction=x), *timed("ray", *of_ray, fraction=x))
    ]
    assert any(p["time_profit_low"] < 0 for p in points_of(rows, ()).profits)
    (panel,) = panels(rows, "time-profit")
    assert panel.y.is_log


def test_makespans_have_the_unit_that_fits() -> None:
    rows = [
        row(policy, fraction=x, makespan_ps=t)
        for x, t in ((0.125, 2 * 10**9), (0.5, 30 * 10**9), (1.0, 4 * 10**9))
        for policy in ("object", "ray")
    ]
    (panel,) = panels(rows, "makespan")
    assert panel.y.label == "makespan (ms)"
    assert panels(rows, "peak-bytes")[0].y.label == "bytes per PE (B)"
    assert [s.mean for s in panel.curves[0].points.values()] == [2, 30, 4]


def test_points_lie_where_they_are_simulated_and_are_one_where_they_are_the_same() -> None:
    """A PE of four owns a quarter, whatever was asked for."""
    cells = {"processors": 4, "effective_fraction": 0.25}
    rows = [
        row(policy, seed, fraction=x, makespan_ps=t + seed, **cells)
        for policy, t in (("object", 9), ("ray", 5))
        for x in (0.05, 0.1)
        for seed in (0, 1)
    ]
    rows += sweep(("object", "ray"), 2, processors=[4], fraction=[0.5])
    (panel,) = panels(rows, "time-profit")
    assert [list(curve.points) for curve in panel.curves] == [[25, 50], [25, 50]]
    assert [list(curve.rows.values()) for curve in panel.curves] == [[0, 4], [1, 5]]


def test_points_that_hold_the_same_and_differ_stay_where_they_were_asked_for() -> None:
    """With room for x fetched objects besides, a PE that owns more than x is another one."""
    rows = [
        row(policy, fraction=x, makespan_ps=t, processors=4, effective_fraction=0.25)
        for policy, times in (("object", (9, 9)), ("ray", (5, 4)))
        for x, t in zip((0.05, 0.1), times, strict=True)
    ]
    rows += sweep(("object", "ray"), 1, processors=[4], fraction=[0.5])
    (panel,) = panels(rows, "time-profit")
    assert [list(curve.points) for curve in panel.curves] == [[5, 10, 50], [5, 10, 50]]


def test_what_is_looked_at_first() -> None:
    rows = sweep(processors=[2, 4, 8], fraction=[0.5, 0.75, 1.0])
    figures = list(profit_figures(ProfitData(points_of(rows, ()))))
    assert [figure.stem for figure in figures if not figure.is_folded] == [
        "makespan-over-fraction",
        "time-profit-over-fraction",
        "speedup",
        "peak-bytes",
    ]
    assert [figure.stem for figure in figures if figure.is_folded] == [
        "makespan-over-processors",
        "time-profit-over-processors",
        "message-profit-over-fraction",
        "message-profit-over-processors",
        "efficiency",
        "node-seconds",
    ]
