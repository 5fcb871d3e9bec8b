"""The data behind every figure of a report are those of the rows."""

from __future__ import annotations

import html
import re
from pathlib import Path
from statistics import fmean
from typing import Any

import plotly.graph_objects as go
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweep_rows import failed, row, sweep

from simmpp.common.files import Row
from simmpp.plot.curves import Bars, Curve, Panel
from simmpp.plot.plotly_panels import drawn
from simmpp.report.page.arrangement import abscissas, arrange
from simmpp.report.page.figures.bar_figures import bar_figures
from simmpp.report.page.figures.figure import Figure
from simmpp.report.page.figures.profit_figures import ProfitData, profit_figures
from simmpp.report.page.folder import Folder
from simmpp.report.page.limits import PointLimits, limits_of_points
from simmpp.report.page.measures import ALL
from simmpp.run import words
from simmpp.sweeps.winners.points import ACCOUNTS, KINDS, Points, points_of

NAMES = st.sampled_from(["plain", "<script>alert(1)</script>", 'a "b" & c', "%{y}", "é", "$x$"])
VALUES: dict[str, Any] = {
    "scene": NAMES,
    "processors": st.integers(1, 4096),
    "fraction": st.one_of(st.just(""), st.floats(0.001, 1)),
    "memory.transient": st.integers(0, 5),
    "point": st.one_of(NAMES, st.integers(0, 3)),
}


@st.composite
def sweeps(draw: st.DrawFn) -> list[Row]:
    """Rows of some sweep: any axes, some points failed or missing."""
    axes = {
        name: draw(st.lists(of, min_size=1, max_size=3, unique=True)) for name, of in VALUES.items()
    }
    policies = draw(
        st.lists(st.sampled_from(["ray", "concurrent", "replicated", "<b>"]), unique=True)
    )
    rows = sweep(["object", *policies], draw(st.integers(1, 2)), **axes)
    rows = [r for r in rows if draw(st.integers(0, 3)) or r["policy"] == "object"][:60]
    return [failed(**keys(r)) if draw(st.integers(0, 9)) == 0 else r for r in rows]


def keys(made: Row) -> dict[str, Any]:
    return {name: made[name] for name in (*VALUES, "policy", "seed")}


few = settings(max_examples=30)
FURTHER = ("memory.transient", "point")


def limits_in(points: Points) -> PointLimits:
    return limits_of_points(Folder(Path(), []), points)


def panels(figures: list[Figure]) -> list[Any]:
    return [panel for figure in figures for panels in figure.plates.values() for panel in panels]


def figures_of(points: Points) -> list[Figure]:
    return [*profit_figures(ProfitData(points)), *bar_figures(limits_in(points))]


@few
@given(rows=sweeps())
def test_curves_show_each_point_of_any_sweep_once(rows: list[Row]) -> None:
    """But points that hold the same objects wherever x was asked to be: these are one."""
    points = points_of(rows, FURTHER)
    for figure in profit_figures(ProfitData(points)):
        name = next(name for name in ALL if figure.stem.startswith(name.replace("_", "-")))
        expected = {n for n in range(len(points.profits)) if ALL[name].spread(points, n)}
        shown = [number for curve in curves_of(figure) for number in curve.rows.values()]
        assert len(set(shown)) == len(shown)
        merged = expected - set(shown)
        assert set(shown) <= expected
        for number in merged:
            assert any(is_one(points, number, other) for other in shown)


def curves_of(figure: Figure) -> list[Curve]:
    return [curve for panel in panels([figure]) for curve in panel.curves]


def is_one(points: Points, one: int, other: int) -> bool:
    """Points of one policy that differ in what was asked for, but not in what is held."""
    keys = [key for key in points.profits[0] if key not in ("fraction",)]
    same = all(points.profits[one][key] == points.profits[other][key] for key in keys)
    return same and points.held(one) == points.held(other)


@few
@given(rows=sweeps())
def test_bars_are_the_accounts_and_messages_of_the_rows(rows: list[Row]) -> None:
    points = points_of(rows, FURTHER)
    accounts, messages = bar_figures(limits_in(points))
    for panel in panels([accounts]):
        assert list(panel.parts) in ([], list(ACCOUNTS))  # without a record no more is known
        for bar, number in enumerate(panel.rows):
            sums = {n: sum(r[c] for r in points.runs[number]) for n, c in ACCOUNTS.items()}
            for name, total in sums.items():
                expected = 100 * total / sum(sums.values())
                assert panel.parts[name][bar] == pytest.approx(expected)
            assert sum(each[bar] for each in panel.parts.values()) == pytest.approx(100)
    for panel in panels([messages]):
        for bar, number in enumerate(panel.rows):
            for name, column in KINDS.items():
                assert panel.parts[name][bar] == fmean(r[column] for r in points.runs[number])
    for figure in (accounts, messages):
        shown = sorted(number for panel in panels([figure]) for number in panel.rows)
        assert shown == [n for n, r in enumerate(points.runs) if r and n not in points.repeated]


@few
@given(rows=sweeps())
def test_plotly_takes_every_figure(rows: list[Row]) -> None:
    for panel in panels(figures_of(points_of(rows, FURTHER))):
        made = drawn(panel)
        go.Figure({"data": made["data"], "layout": made["layout"]})  # refuses what it does not know
        assert "<script" not in str(made["data"]) + str(made["layout"])


@few
@given(rows=sweeps())
def test_every_plate_has_files_of_its_own(rows: list[Row]) -> None:
    stems = [s for figure in figures_of(points_of(rows, FURTHER)) for s in figure.files.values()]
    assert len(set(stems)) == len(stems)
    assert all(re.fullmatch("[a-z0-9][a-z0-9.-]{,120}", stem) for stem in stems)


def varying_axes(rows: list[Row]) -> dict[str, list[object]]:
    return points_of(rows, FURTHER).axes


def with_further(rows: list[Row]) -> list[Row]:
    return [{"memory.transient": 0, "point": "p"} | r for r in rows]


def test_numbers_run_along_before_texts_and_the_axis_with_most_values_first() -> None:
    rows = with_further(sweep(scene=list("abcde"), processors=[1, 2, 4], fraction=[0.1, 0.5, 1.0]))
    assert abscissas(varying_axes(rows)) == ["fraction", "processors"]
    assert abscissas(varying_axes(with_further(sweep(scene=list("abc"))))) == ["scene"]
    assert abscissas(varying_axes(with_further(sweep()))) == ["policy"]


def test_an_axis_that_follows_from_the_abscissa_splits_no_curve() -> None:
    rows = with_further(
        [row(p, processors=n, point=f"p{n}") for n in (8, 64) for p in ("object", "ray")]
    )
    points = points_of(rows, FURTHER)
    found = arrange(points.profits, points.axes, "processors")
    assert (found.facet, found.plate_axes) == (None, ())


def test_an_axis_with_many_values_is_chosen_from() -> None:
    rows = with_further(
        [
            row(p, fraction=x, scene=s, **{"memory.transient": n})
            for n in range(13)
            for x in (n / 100 for n in range(1, 20))
            for s in "ab"
            for p in ("object",)
        ]
    )
    points = points_of(rows, FURTHER)
    found = arrange(points.profits, points.axes, "fraction")
    assert (found.facet, found.plate_axes) == ("scene", ("memory.transient",))


def test_policies_have_the_same_colour_everywhere() -> None:
    rows = with_further(sweep(["object", "ray", "z", "a"], fraction=[0.1, 1.0]))
    rows = [r for r in rows if r["policy"] != "ray" or r["fraction"] == 1.0]
    styles = {
        (curve.label, curve.style)
        for panel in panels(figures_of(points_of(rows, FURTHER)))
        if isinstance(panel, Panel)
        for curve in panel.curves
    }
    known = len(words.PAPER_WORDS)
    assert styles == {("object dataflow", 0), ("ray dataflow", 1), ("a", known), ("z", known + 1)}


def test_bars_of_policies_come_in_the_order_of_their_colours() -> None:
    points = points_of(sweep(fraction=[0.1, 1.0]), ())
    (accounts, _) = bar_figures(limits_in(points))
    (plate,) = accounts.plates.values()
    assert [panel.title for panel in plate if isinstance(panel, Bars)] == [
        "object dataflow",
        "ray dataflow",
        "concurrent dataflow",
        "replicated scene",
    ]


def test_bars_of_the_same_simulations_are_one() -> None:
    cells = {"processors": 4, "effective_fraction": 0.25}
    rows = [
        row(p, fraction=x, makespan_ps=5, **cells) for p in ("object", "ray") for x in (0.05, 0.1)
    ]
    points = points_of([*rows, *sweep(("object", "ray"), 1, processors=[4], fraction=[0.5])], ())
    for figure in bar_figures(limits_in(points)):
        for panel in panels([figure]):
            assert panel.x.names == ("25", "50")


def test_plotly_reads_html_so_labels_are_escaped() -> None:
    hostile = "<b>\"eager\"</b> & 'lazy'"
    points = points_of(
        with_further([row(p, fraction=x) for p in ("object", hostile) for x in (0.1, 1.0)]), FURTHER
    )
    (panel,) = next(profit_figures(ProfitData(points))).plates[""]
    assert [trace["name"] for trace in drawn(panel)["data"]] == [
        "object dataflow",
        html.escape(hostile),
    ]
    named = with_further([row(point=hostile), row(point="plain")])
    points = points_of(named, FURTHER)
    (panel,) = next(profit_figures(ProfitData(points))).plates[""]
    assert html.escape(hostile) in drawn(panel)["layout"]["xaxis"]["ticktext"]


def test_values_that_look_alike_have_panels_of_their_own() -> None:
    rows = with_further([row(processors=n, fraction=x) for n in (1, 2, 3) for x in (0.1, 0.10001)])
    points = points_of(rows, FURTHER)
    figure = next(profit_figures(ProfitData(points)))
    (plate,) = figure.plates.values()
    assert [panel.title for panel in plate] == ["x = 10 %", "x = 10 % (2)"]
