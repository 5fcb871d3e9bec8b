"""Ratios are the seed's own; what failed is missing; curves and files follow from them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from simmpp.plot.curves import Curve, Panel, Scale, Spread, Stated
from simmpp.plot.matplotlib_panels import draw
from simmpp.studies.nebel98.evidence import At, rank_correlation
from simmpp.studies.nebel98.figures import curve
from simmpp.sweeps.ratios import MAKESPAN, MESSAGES, CurvePoint, RowIndex, mean


def row(policy: str, seed: int, time: int, messages: int = 1, error: str = "") -> dict[str, Any]:
    return {
        "scene": "s",
        "processors": 8,
        "fraction": 0.5,
        "policy": policy,
        "seed": seed,
        "makespan_ps": time,
        "messages": messages,
        "compute_ps": time,
        "communication_ps": 2 * time,
        "waiting_ps": time,
        "error": error,
    }


ROWS = [
    row("object", 0, 100, 8),
    row("object", 1, 300, 0),
    row("object", 2, 900),
    row("concurrent", 1, 100, 0),
    row("concurrent", 0, 50, 2),
    row("concurrent", 2, 1, error="timeout"),
    row("concurrent", 3, 1),
]


def test_profits_pair_seeds_that_both_have() -> None:
    measured = RowIndex(ROWS)
    assert measured.profit(MAKESPAN, "s", 8, 0.5, "concurrent") == (2.0, 3.0)
    assert measured.profit(MESSAGES, "s", 8, 0.5, "concurrent") == (4.0, 1.0)
    assert measured.profit(MAKESPAN, "s", 8, 0.5, "ray") == ()
    assert math.isnan(mean(()))


def test_accounts_are_shares() -> None:
    accounts = RowIndex(ROWS).accounts(CurvePoint("s", 8, 0.5, "object"))
    assert accounts == {"compute": 0.25, "communication": 0.5, "waiting": 0.25}
    assert RowIndex(ROWS).accounts(CurvePoint("s", 8, 0.5, "ray")) == {}


def test_curves_are_means_with_the_range_of_the_seeds() -> None:
    points = {x * 100: CurvePoint("s", 8, x, "ray") for x in (0.1, 0.2, 0.3)}
    ratios = {0.1: (1.0, 3.0, 5.0), 0.3: (2.0,)}
    measured = RowIndex(ROWS, {points[10.0]: 7, points[20.0]: 8})
    drawn = curve("c", measured, points, lambda point: ratios.get(point.fraction, ()))
    spreads = {10.0: Spread(3.0, 1.0, 5.0), 0.3 * 100: Spread(2.0, 2.0, 2.0)}
    assert drawn == Curve("c", spreads, rows={10.0: 7})


def test_rank_correlation_is_spearmans() -> None:
    a, b, c = (
        {At("s", 8, x): value for x, value in zip((3.0, 1.0, 2.0, 4.0), values, strict=True)}
        for values in ((1, 2, 3, 4), (10, 20, 30, 400), (1, 1, 1, 1))
    )
    assert rank_correlation(a, b) == 1
    assert math.isnan(rank_correlation(a, c))
    assert round(rank_correlation(a, {**a, At("s", 8, 3.0): 9}), 6) == -0.2


def test_equal_figures_are_equal_bytes(tmp_path: Path) -> None:
    points = {1.0: Spread(1.0, 0.5, 1.5), 2.0: Spread(2.0, 1.5, 2.5)}
    panel = Panel(
        "title",
        Scale("x (%)", ticks=(1, 2)),
        Scale("y", is_log=True),
        [Curve("c", points), Curve("guide", points, is_guide=True)],
        [Stated(1, 2, 1, 2, "said")],
        level=1,
        note="so",
    )
    first = [path.read_bytes() for path in draw([panel, panel], tmp_path / "a")]
    again = [path.read_bytes() for path in draw([panel, panel], tmp_path / "b")]
    assert first == again
    assert b"<dc:date>" not in first[1]


def test_ranks_are_shared_and_a_missing_value_leaves_none() -> None:
    xs = (0.1, 0.2, 0.3, 0.4)
    a, tied, missing = (
        {At("s", 8, x): value for x, value in zip(xs, values, strict=True)}
        for values in ((1, 2, 3, 4), (5, 7, 7, 9), (1, 2, math.nan, 4))
    )
    assert round(rank_correlation(a, tied), 6) == 0.948683  # (1, 2.5, 2.5, 4): 4.5 / sqrt(5 * 4.5)
    assert math.isnan(rank_correlation(a, missing))
