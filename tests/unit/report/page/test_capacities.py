"""Memory that ends: what does not fit, knees, maps and parts are those of the rows."""

from __future__ import annotations

from pathlib import Path

import plotly.graph_objects as go
import pytest
from sweep_rows import UNFIT, bounded, row, written

from simmpp.common.files import Row
from simmpp.engine.memory_use import COLUMNS
from simmpp.methods.columns import BOUNDED
from simmpp.plot.curves import Bars, Panel, Tiles
from simmpp.plot.matplotlib_panels import drawing
from simmpp.plot.plotly_panels import alt_text, drawn
from simmpp.report.page.comparison import compared
from simmpp.report.page.figures.capacity_figures import capacity_figures
from simmpp.report.page.figures.figure import Figure
from simmpp.report.page.folder import read_folder
from simmpp.report.page.report import report_of, write_page
from simmpp.sweeps.profits import best_policy
from simmpp.sweeps.winners.answer import answer_of
from simmpp.sweeps.winners.fit_table import fit_table
from simmpp.sweeps.winners.knee import KNEES_BYTES, knee_table, knee_tables, knees
from simmpp.sweeps.winners.points import Points, points_of

GB = 10**9
CAPACITY = "memory.capacity"
SIZES = ("4 GB", "8 GB", "16 GB", "32 GB", "null")
TIMES: dict[str, tuple[int | None, ...]] = {  # ms; None does not fit
    "object": (None, 900, 190, 104, 100),
    "ray": (120, 120, 120, 120, 120),
    "replicated": (None, None, None, None, 50),
}


def rows(nb: int = 8) -> list[Row]:
    """A sweep along the capacity, as it would be written."""
    return [
        bounded(policy, None if of is None else of * 10**9, size, processors=nb)
        for policy, times in TIMES.items()
        for size, of in zip(SIZES, times, strict=True)
    ]


def points(rows: list[Row]) -> Points:
    return points_of(rows, (CAPACITY,))


def figures(rows: list[Row]) -> dict[str, Figure]:
    return {figure.stem: figure for figure in capacity_figures(points(rows))}


def test_what_does_not_fit_is_said_with_what_it_lacks_and_where() -> None:
    told = [sentence.text for sentence in answer_of(rows(), (CAPACITY,))]
    assert told[2:4] == [
        "The replicated scene does not fit in 4 of 5 cases (memory per PE up to 32 GB): each PE "
        "lacks 3 GB.",
        "Object dataflow does not fit in 1 of 5 cases (memory per PE 4 GB): each PE lacks 3 GB.",
    ]
    assert not any("failed" in text or "no result" in text for text in told)


def test_where_the_scene_fits_it_is_a_choice_and_no_ceiling() -> None:
    some = [bounded("replicated", 50, "32 GB", effective_fraction=1.0)]
    some += [bounded(policy, 100, "32 GB") for policy in ("object", "ray")]
    told = [sentence.text for sentence in answer_of(some, (CAPACITY,))]
    assert told[1:] == [
        "The whole scene fits into the memory of a PE: held there (replicated, no dataflow) the "
        "job takes 0.5 times as long as with the fastest dataflow."
    ]
    several = [*some, *(bounded(p, 100, "8 GB") for p in ("object", "ray"))]
    several.append(bounded("replicated", None, "8 GB"))
    told = [sentence.text for sentence in answer_of(several, (CAPACITY,))]
    assert any("fits into the memory of a PE in 1 of 2 cases: held" in text for text in told)
    assert not any("ceiling" in text for text in told)


def test_where_nothing_fits_the_answer_is_what_is_lacking() -> None:
    some = [bounded(policy, None, "4 GB", processors=nb) for policy in TIMES for nb in (4, 8)]
    told = [sentence.text for sentence in answer_of(some, (CAPACITY,))]
    assert told == [
        "Nothing fits into the memory of a PE: at least 7 GB would do (object dataflow, 4 PEs).",
        "Nothing fits in all 2 cases (4 to 8 PEs): each PE lacks 3 GB.",
    ]


def test_where_no_dataflow_fits_but_the_scene_does_the_least_of_a_dataflow_is_said() -> None:
    some = [
        bounded("replicated", 50, "4 GB"),
        *(bounded(p, None, "4 GB") for p in ("object", "ray")),
    ]
    some[2]["least_bytes"] = 5 * GB
    told = [sentence.text for sentence in answer_of(some, (CAPACITY,))]
    assert told[0] == (
        "No dataflow fits into the memory of a PE: at least 5 GB would do (ray dataflow)."
    )


@pytest.mark.parametrize(
    ("cells", "sentence"),
    [
        (
            {"infeasible": 1, "reason": "PE 1 is stuck"},
            "Object dataflow came to no end, as no PE could go on: PE 1 is stuck.",
        ),
        (
            {"fits": 0, "exceeds_bytes": 1_234_567, "makespan_ps": 7},
            "Object dataflow held more than a PE has, by 1.23 MB.",
        ),
    ],
)
def test_stuck_and_exceeding_runs_are_told_apart(cells: Row, sentence: str) -> None:
    stuck = bounded("object", None, "4 GB") | {"fits": 1, "exceeds_bytes": 0} | cells
    one = [row("ray", fraction=0.1), stuck]
    assert sentence in [of.text for of in answer_of(one)]


def test_profits_and_the_best_so_far_are_those_of_runs_that_ended() -> None:
    of = points(rows())
    unknown = {(r["policy"], r[CAPACITY]) for r in of.profits if r["time_profit"] == ""}
    assert ("object", 4 * GB) in unknown and ("ray", 4 * GB) in unknown
    assert ("ray", 8 * GB) not in unknown
    assert best_policy(rows(), (CAPACITY,)) is not None


def test_a_knee_is_the_least_capacity_with_at_most_so_long_a_makespan() -> None:
    of = points(rows())
    told = {str(of.profits[k.reference]["policy"]): (k.least, k.knee_bytes) for k in knees(of)}
    assert told == {
        "object": (8 * GB, (32 * GB, 16 * GB, 8 * GB)),
        "ray": (4 * GB, (4 * GB,) * 3),
    }
    assert {line["compared with"] for line in knee_table(of)} == {"unbounded memory"}
    written, _ = knee_tables(rows(), (CAPACITY,), [])["knees.csv"]
    (of_object,) = (line for line in written if line["policy"] == "object")
    assert [of_object[name] for name in KNEES_BYTES] == [32 * GB, 16 * GB, 8 * GB]
    assert (of_object["compared_with"], of_object["least_fitting_bytes"]) == ("none", 8 * GB)
    assert knee_tables(rows(), ("point",), []) == {}
    bare = points([r for r in rows() if r[CAPACITY] != "null"])
    assert {line["compared with"] for line in knee_table(bare)} == {"32 GB per PE"}


def test_a_larger_capacity_that_is_slower_moves_no_knee() -> None:
    times = {"4 GB": 102, "8 GB": 300, "16 GB": 101, "null": 100}
    of = points([bounded("object", t, size) for size, t in times.items()])
    assert [knee.knee_bytes for knee in knees(of)] == [(4 * GB, 4 * GB, 4 * GB)]


def test_the_table_says_for_each_case_who_fits() -> None:
    lines = fit_table(points(rows()))
    assert [line[CAPACITY] for line in lines] == ["4 GB", "8 GB", "16 GB", "32 GB"]
    assert lines[0]["object dataflow"] == "does not fit: lacks 3 GB"
    assert lines[1]["object dataflow"] == "fits"


def test_the_map_has_a_winner_or_nothing_for_each_case() -> None:
    of = [*rows(4), *rows(8)]
    of = [r if r["processors"] == 8 or r[CAPACITY] != "4 GB" else r | UNFIT for r in of]
    (tiles,) = figures(of)["capacity-map"].plates[""]
    assert isinstance(tiles, Tiles)
    assert tiles.x.names == ("4 GB", "8 GB", "16 GB", "32 GB", "unbounded")
    found = {layer.label: [(t.x, t.y) for t in layer.tiles] for layer in tiles.layers}
    assert found["nothing fits"] == [(0, 0)]
    assert sorted(found["ray dataflow"]) == [(0, 1), (1, 0), (1, 1), (2, 0), (2, 1)]
    assert sorted(found["object dataflow"]) == [(3, 0), (3, 1), (4, 0), (4, 1)]
    assert tiles.layers[-1].style is None


def test_makespans_have_a_strip_where_a_policy_does_not_fit() -> None:
    (panel,) = figures(rows())["makespan-by-capacity"].plates[""]
    assert isinstance(panel, Panel)
    measured = {c.label: sorted(c.points) for c in panel.curves if not c.is_guide}
    assert measured == {"object dataflow": [8, 16, 32], "ray dataflow": [4, 8, 16, 32]}
    strips = {strip.label: (strip.left, strip.right) for strip in panel.hatched}
    assert strips["object dataflow"][0] < 4 < strips["object dataflow"][1] < 8
    assert strips["replicated scene"][0] < 4 and strips["replicated scene"][1] > 32
    lowest = min(of.low for curve in panel.curves for of in curve.points.values())
    assert all(strip.high < lowest for strip in panel.hatched)


def test_bars_are_the_parts_of_the_fullest_pe() -> None:
    bars = figures(rows())["memory-of-the-fullest"].plates[""]
    assert [of.title for of in bars] == ["object dataflow", "ray dataflow"]
    assert isinstance(bars[0], Bars) and bars[0].x.names == ("8 GB", "16 GB", "32 GB")
    assert [sum(of) for of in bars[0].parts.values()] == [3 * 10, 3 * 20, 3 * 30, 3 * 40]


def test_figures_are_drawn_on_pages_and_on_paper() -> None:
    for figure in figures(rows()).values():
        for panels in figure.plates.values():
            drawing(panels)
            for panel in panels:
                of = drawn(panel)
                go.Figure(of["data"], of["layout"])  # raises for what plotly does not know
                assert "nothing" not in alt_text(panel)


def test_memory_without_an_end_has_no_such_figures() -> None:
    assert not list(capacity_figures(points_of([row("object"), row("ray")], ())))


@pytest.mark.parametrize("of", [rows(), [r | UNFIT for r in rows()]], ids=["some fit", "none"])
def test_the_page_shows_what_fits_and_folders_are_compared(of: list[Row], tmp_path: Path) -> None:
    folders = {
        name: read_folder(written(tmp_path / name, of, (CAPACITY,), (BOUNDED,)))
        for name in ("one", "other")
    }
    page = write_page(report_of(folders["one"])).read_text()
    assert "What fits into memory" in page and "does not fit: lacks 3 GB" in page
    (pair,) = compared(folders)
    assert pair.sweeps.common == 15 and not pair.sweeps.changes


def test_why_a_run_came_to_no_end_is_read_where_its_row_is_shown(tmp_path: Path) -> None:
    stuck = bounded("object", None, "4 GB") | {"fits": 1, "exceeds_bytes": 0, "infeasible": 1}
    stuck |= {"reason": "PE 1 is stuck with 2 rays, of 7 that are left"}
    folder = written(tmp_path, [stuck, bounded("ray", 5, "4 GB")], (CAPACITY,), (BOUNDED,))
    page = write_page(report_of(read_folder(folder))).read_text()
    assert "stuck: PE 1 is stuck with 2 rays, of 7 that are left" in page


def test_a_row_without_a_result_has_to_say_why(tmp_path: Path) -> None:
    silent = bounded("object", None, "4 GB") | dict.fromkeys(COLUMNS, "")
    folder = written(tmp_path, [silent], (CAPACITY,), (BOUNDED,))
    with pytest.raises(Exception, match="expected results or an error"):
        read_folder(folder)
