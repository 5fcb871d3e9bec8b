"""Who wins where, and whether seeds can tell: by hand, and by Student's table."""

from __future__ import annotations

import math
from statistics import stdev

import pytest
from sweep_rows import failed, row, timed

from simmpp.common.files import Row
from simmpp.sweeps.intervals import PLAIN
from simmpp.sweeps.winners.contest import (
    ALONE,
    EQUAL,
    SURE,
    TOO_FEW_SEEDS,
    UNSURE,
    Contest,
    contests_of,
    replicated_policies,
)
from simmpp.sweeps.winners.points import points_of

T_2 = 4.302652729911275
"""Student's t of 97.5 % with 2 degrees of freedom (any table)."""


def only(rows: list[Row]) -> Contest:
    (found,) = contests_of(points_of(rows, ()))
    return found


def test_the_lead_is_the_mean_of_the_seeds_own_ratios() -> None:
    found = only(timed("object", 300, 500, 400) + timed("ray", 100, 250, 200))
    assert found.lead == pytest.approx((3 * 2 * 2) ** (1 / 3))
    logarithms = [math.log(value) for value in (3, 2, 2)]
    factor = math.exp(T_2 * stdev(logarithms) / math.sqrt(3))
    assert (found.low, found.high) == pytest.approx((found.lead / factor, found.lead * factor))
    assert found.certainty == SURE


def test_a_lead_is_sure_beyond_its_interval() -> None:
    assert only(timed("object", 300, 301, 302) + timed("ray", 100, 100, 100)).certainty == SURE


def test_policies_that_never_differ_are_equal() -> None:
    assert only(timed("object", 3, 4) + timed("ray", 3, 4)).certainty == EQUAL


def test_one_seed_tells_nothing() -> None:
    assert only(timed("object", 300) + timed("ray", 100)).certainty == TOO_FEW_SEEDS


def test_a_dataflow_alone_wins_without_a_lead() -> None:
    assert only(timed("object", 300, 400)).certainty == ALONE


def test_seeds_that_only_one_has_do_not_count() -> None:
    rows = timed("object", 300, 300, 300) + timed("ray", 200, 200) + [failed("ray", 2)]
    assert only(rows).lead == 1.5
    apart = [*timed("object", 300), failed("object", 1), failed("ray", 0), row("ray", 1)]
    found = only(apart)
    assert math.isnan(found.lead)
    assert found.certainty == TOO_FEW_SEEDS


def test_the_replicated_scene_is_no_dataflow_whatever_its_label() -> None:
    rows = timed("object", 300, 300) + timed("ray", 200, 200)
    rows += timed("all there", 100, 100, effective_fraction=1.0)
    points = points_of(rows, ())
    assert replicated_policies(points) == {"all there", "replicated"}
    (found,) = contests_of(points)
    assert points.profits[found.best]["policy"] == "ray"
    assert found.ceiling == 2


def test_where_all_is_resident_nobody_is_the_replicated_scene() -> None:
    rows = timed("object", 300, fraction=1.0, effective_fraction=1.0)
    assert replicated_policies(points_of(rows, ())) == {"replicated"}


def test_where_everyone_holds_everything_all_are_dataflows() -> None:
    rows = [r for p in ("object", "ray") for r in timed(p, 300, processors=1, effective_fraction=1)]
    assert only(rows).certainty == EQUAL


def test_intervals_are_as_wide_as_where_seeds_were_chosen() -> None:
    rows = timed("object", 100, 100, 100, 100) + timed("ray", 106, 103, 105, 104)
    plain, wide = (contests_of(points_of(rows, (), confidence=c))[0] for c in (PLAIN, 0.9999))
    assert (plain.certainty, wide.certainty) == (SURE, UNSURE)
    assert wide.low < 1 < plain.low


def test_a_lead_is_sure_only_if_it_is_over_every_other() -> None:
    rows = timed("ray", 100, 100, 100) + timed("object", 110, 110, 110)
    rows += timed("concurrent", 100, 300, 100)
    found = only(rows)
    assert found.certainty == UNSURE
    assert found.second is not None  # the mean of the third is larger, yet it may be the fastest
    assert points_of(rows, ()).flow(found.second) == "concurrent dataflow"  # of object it is sure
    assert [points_of(rows, ()).flow(n) for n in found.rivals] == ["concurrent dataflow"]


def test_the_winner_does_not_depend_on_how_ratios_are_taken() -> None:
    """By mean makespans ray dataflow would be slower, by the mean ratio it would lead."""
    found = only(timed("object", 100, 1000) + timed("ray", 10, 10000))
    assert found.lead == pytest.approx(1)


def test_places_that_are_the_same_simulations_are_one_case() -> None:
    rows = [
        row(p, fraction=x, effective_fraction=0.125, makespan_ps=t)
        for p, t in (("object", 9), ("ray", 5))
        for x in (0.01, 0.05)
    ]
    rows += [row(p, fraction=0.5, makespan_ps=7) for p in ("object", "ray")]
    points = points_of(rows, ())
    assert [points.at(case[0], "fraction") for case in points.cases] == [0.125, 0.5]
    other = points_of(
        [*rows[:-1], row("ray", fraction=0.05, makespan_ps=4, effective_fraction=0.125)], ()
    )
    assert [other.at(case[0], "fraction") for case in other.cases] == [0.01, 0.05, 0.5]
