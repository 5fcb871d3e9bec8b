"""What moved between two sweeps, by hand."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from sweep_rows import failed, row, sweep

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row
from simmpp.report.page.comparison import causes, outcome
from simmpp.report.page.difference import (
    BEYOND,
    TOO_FEW_SEEDS,
    WITHIN,
    Change,
    changes_by_measure,
    difference_of,
    line,
    ranked,
)
from simmpp.report.page.folder import Folder


def folder(rows: list[Row], *further: str, **record: object) -> Folder:
    return Folder(Path("x"), rows, further, record=record)


def changes(before: list[Row], after: list[Row]) -> dict[tuple[int, str], Change]:
    found = difference_of(folder(before), folder(after))
    return {(change.number, change.measure): change for change in found.changes}


def timed(*makespans_ps: int, policy: str = "object", first: int = 0, **cells: object) -> list[Row]:
    return [
        row(policy, seed, makespan_ps=t, messages=100, **cells)
        for seed, t in enumerate(makespans_ps, first)
    ]


def test_equal_sweeps_have_no_changes() -> None:
    rows = sweep(fraction=[0.1, 0.5], processors=[8, 64])
    found = difference_of(folder(rows), folder(rows))
    assert (found.common, found.changes, found.only_before, found.only_after) == (16, [], [], [])
    assert outcome(found) == "16 points in both; nothing moved."


def test_seeds_are_compared_one_by_one() -> None:
    """Each seed is 1 % slower, though seeds differ by half: sure, as no interval overlap tells."""
    (found,) = changes(timed(1000, 1500, 2000), timed(1010, 1515, 2020)).values()
    assert (found.measure, found.ratio, found.certainty) == (
        "makespan",
        pytest.approx(1.01),
        BEYOND,
    )
    assert (found.before, found.after) == (1500, 1515)


def test_a_change_within_the_interval_is_none_to_be_sure_of() -> None:
    (found,) = changes(timed(100, 100, 100), timed(90, 100, 115)).values()
    assert found.certainty == WITHIN
    assert found.ratio == pytest.approx(1.01666667)


def test_one_seed_tells_nothing() -> None:
    (found,) = changes(timed(100), timed(90)).values()
    assert found.certainty == TOO_FEW_SEEDS


@pytest.mark.parametrize(
    ("after", "certainty"),
    [((110, 111, 112), BEYOND), ((101, 102, 103), WITHIN), ((110,), TOO_FEW_SEEDS)],
)
def test_without_common_seeds_the_means_intervals_are_compared(
    after: tuple[int, ...], certainty: str
) -> None:
    (found,) = changes(timed(100, 101, 102), timed(*after, first=10)).values()
    assert found.certainty == certainty
    assert found.ratio == pytest.approx(sum(after) / len(after) / 101)


def test_profits_are_of_the_same_seed() -> None:
    before = timed(300, 500) + timed(100, 250, policy="ray")
    after = timed(300, 500) + timed(150, 500, policy="ray")
    found = changes(before, after)
    assert set(found) == {(1, "makespan"), (1, "time profit")}
    gain = found[1, "time profit"]
    assert (gain.before, gain.after) == (2.5, 1.5)
    assert gain.ratio == pytest.approx(((2 / 3) + (1 / 2)) / 2)


def test_points_that_only_one_has_are_told() -> None:
    rows = sweep(["object"], fraction=[0.1, 0.5, 1.0])
    found = difference_of(folder(rows[:6]), folder(rows[3:]))
    assert found.common == 1
    assert found.only_before == ["x = 10 %, object dataflow"]
    assert found.only_after == ["x = 100 %, object dataflow"]
    assert outcome(found) == "1 point in both, 1 only before, 1 only after; nothing moved."


def test_failed_points_have_no_changes() -> None:
    assert changes([failed()], timed(100)) == {}
    assert changes(timed(0), timed(0)) == {}


def test_something_from_nothing_is_infinitely_more() -> None:
    (found,) = changes(timed(0, 0), timed(5, 5)).values()
    assert (found.ratio, found.certainty) == (math.inf, TOO_FEW_SEEDS)
    assert line(found)["change"] == "+inf %"


def test_an_axis_that_only_one_has_is_refused_unless_it_has_one_value() -> None:
    rows = sweep(["object"])
    one = [r | {"memory.transient": 4} for r in rows]
    two = [*one, *(r | {"memory.transient": 8} for r in rows)]
    assert difference_of(folder(one, "memory.transient"), folder(rows)).common == 1
    for pair in (
        (folder(two, "memory.transient"), folder(rows)),
        (folder(rows), folder(two, "memory.transient")),
    ):
        with pytest.raises(ConfigError, match=r"no column memory\.transient, which varies in"):
            difference_of(*pair)


def test_the_summary_counts_by_measure_and_sure_changes_come_first() -> None:
    before = (
        timed(100, 101, fraction=0.1) + timed(100, 100, fraction=0.5) + timed(7, 7, fraction=1.0)
    )
    after = timed(50, 150, fraction=0.1) + timed(101, 101, fraction=0.5) + timed(7, 7, fraction=1.0)
    found = difference_of(folder(before), folder(after))
    makespans = changes_by_measure(found)[0]
    assert makespans == {
        "measure": "makespan",
        "points in both": "3",
        "moved": "2",
        BEYOND: "1",
        "from": "-0.743 %",
        "to": "+1 %",
    }
    assert [c.certainty for c in ranked(found.changes)] == [BEYOND, WITHIN]
    assert outcome(found) == "3 points in both; 2 moved, 1 beyond the 95 % interval."


def test_settings_that_differ_are_told() -> None:
    before = folder([], config={"machine": {"preset": "t3e"}}, versions={"numpy": "1"})
    after = folder([], config={"machine": {"preset": "t3d"}}, versions={"numpy": "1"})
    assert causes(before, after) == ["config.machine.preset is t3e before, t3d after"]
    assert causes(before, before) == []
    assert causes(folder([]), folder([])) == []
