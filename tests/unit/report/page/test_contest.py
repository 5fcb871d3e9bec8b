"""Who wins where, and whether seeds can tell: by hand, and by Student's table."""

from __future__ import annotations

import math

import pytest
from sweep_rows import failed, row

from simmpp.common.files import Row
from simmpp.report.page.findings import sentences, wins
from simmpp.run import words
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


def timed(policy: str, *makespans_ps: int, **cells: object) -> list[Row]:
    return [row(policy, seed, makespan_ps=t, **cells) for seed, t in enumerate(makespans_ps)]


def only(rows: list[Row]) -> Contest:
    (found,) = contests_of(points_of(rows, ()))
    return found


def test_the_lead_is_the_mean_of_the_seeds_own_ratios() -> None:
    found = only(timed("object", 300, 500, 400) + timed("ray", 100, 250, 200))
    assert found.lead == pytest.approx((3 + 2 + 2) / 3)
    half = T_2 * math.sqrt(1 / 3) / math.sqrt(3)  # of 3, 2, 2
    assert (found.low, found.high) == pytest.approx((7 / 3 - half, 7 / 3 + half))
    assert found.low < 1
    assert found.certainty == UNSURE


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


def at(fraction: float, *of: tuple[str, tuple[int, ...]]) -> list[Row]:
    return [r for policy, t in of for r in timed(policy, *t, fraction=fraction)]


def test_neighbours_with_one_winner_are_one_line() -> None:
    rows = at(0.1, ("object", (300, 301)), ("ray", (100, 100)))
    rows += at(0.2, ("object", (200, 201)), ("ray", (100, 100)))
    rows += at(0.4, ("object", (100, 100)), ("ray", (110, 130)))
    rows += at(0.8, ("object", (303, 302)), ("ray", (100, 100)))
    rows += at(1.0, ("object", (100, 100)), ("ray", (100, 100)))
    found = wins(points_of(rows, ()))
    assert [(w.winner, w.where, w.places) for w in found] == [
        ("ray", "10 % to 20 %, 80 %", 3),
        ("object", "40 %", 1),
        ("object = ray", "100 %", 1),
    ]
    assert found[0].profit == "2 to 3.02"
    assert found[0].lead == "100 to 202 % over object"
    assert [w.sure for w in found] == [
        "beyond the 95 % interval at each",
        "no difference that these seeds can show",
        "equal in every seed",
    ]
    first, *_ = sentences(points_of(rows, ()))
    assert first == (
        "Of 5 places (x) the fastest dataflow is ray dataflow at 3; object dataflow at 1 (by no "
        "more than seeds differ); at 1 the two fastest are equal."
    )


def test_rows_that_all_failed_are_said_to_have_no_result() -> None:
    assert sentences(points_of([failed()], ())) == ["No point has a result."]
    assert sentences(points_of([], ())) == ["No point has a result."]


@pytest.mark.parametrize(
    ("values", "text"),
    [((1.0, 1.7123), "1 to 1.71"), ((2.0001, 2.0), "2"), ((), ""), ((1, math.inf), "1 to inf")],
)
def test_spans(values: tuple[float, ...], text: str) -> None:
    assert words.span(values) == text
