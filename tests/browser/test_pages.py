"""Pages of report and compare in a real browser: `python -m pytest -m browser`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest
from sweep_rows import HOSTILE, written

from simmpp.common.files import Row
from simmpp.methods.columns import NUMBERS
from simmpp.report.page.folder import Folder, read_folder
from simmpp.report.page.limits import limits_of_points
from simmpp.report.page.report import report_of, write_page
from simmpp.run import words
from simmpp.sweeps.winners.points import Points, points_of

PAGES = ["report", "run", "bench", "reproduction", "comparison", "several", "comparisons"]
LOOKS = [(400, "light"), (400, "dark"), (1400, "light"), (1400, "dark")]
BACKGROUND = {"light": "rgb(255, 255, 255)", "dark": "rgb(20, 24, 29)"}


@pytest.mark.parametrize(("width", "theme"), LOOKS)
@pytest.mark.parametrize("name", PAGES)
def test_a_page_fits_its_window_in_both_themes(
    opened: Any, request: pytest.FixtureRequest, name: str, width: int, theme: str
) -> None:
    """And, as the fixture checks, says nothing on the console and asks for nothing but itself."""
    found = opened(request.getfixturevalue(name), width, theme)
    found.draw_all()
    assert found.width_beyond_window() == 0
    assert found.violations() == []
    colour = found.page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert colour == BACKGROUND[theme]
    assert len(found.asked) == 1
    found.keep(f"{name}-{width}-{theme}")


def number_of(points: Points, **keys: Any) -> int:
    """The number of the point with these keys."""
    numbers = range(len(points.profits))
    (number,) = (n for n in numbers if all(points.profits[n][k] == v for k, v in keys.items()))
    return number


def place_of(page: Any, panel: Any, number: int) -> tuple[float, float]:
    """Where in the window a point of a curve is; it is scrolled there."""
    panel.scroll_into_view_if_needed()
    panel.locator(".main-svg").first.wait_for()
    panel.evaluate("chart => chart.scrollIntoView({block: 'center', behavior: 'instant'})")
    x, y = panel.evaluate(
        """(chart, number) => {
            const { xaxis, yaxis } = chart._fullLayout, box = chart.getBoundingClientRect();
            for (const trace of chart.data) {
                const at = (trace.customdata || []).indexOf(number);
                if (at >= 0) return [box.x + xaxis._offset + xaxis.d2p(trace.x[at]),
                                     box.y + yaxis._offset + yaxis.d2p(trace.y[at])];
            }
        }""",
        number,
    )
    return x, y


def cells(page: Any, table: str) -> dict[str, list[str]]:
    """The cells of each row of a table, by its first."""
    found = page.locator(f"{table} tr").evaluate_all(
        "rows => rows.map(row => [...row.cells].map(cell => cell.textContent))"
    )
    return {first: others for first, *others in found}


CHOSEN = {"scene": "mountain:4", "processors": 64, "fraction": 0.1, "policy": "concurrent"}
CALLED = "mountain:4, 64 PEs, x = 10 %: concurrent dataflow"


@pytest.mark.parametrize("width", [390, 1600])
def test_clicking_a_point_of_a_curve_shows_its_rows(
    opened: Any, report: Path, rows: list[Row], width: int
) -> None:
    points = points_of(rows, ())
    number = number_of(points, **CHOSEN)
    page = opened(report, width).page
    page.locator("#time-profit select").select_option("64 PEs")
    panel = page.locator("#time-profit .panel").filter(has_text="mountain:4").locator(".chart")
    x, y = place_of(page, panel, number)
    (page.touchscreen.tap if width < 500 else page.mouse.click)(x, y)
    page.locator("#point-title", has_text=CALLED).wait_for()
    shown = cells(page, "#point-rows")
    for name in ("seed", *NUMBERS):
        integers = [int(text.replace(",", "")) for text in shown[name]]
        assert integers == [row[name] for row in points.runs[number]]
    assert unquote(page.url).endswith("#point=mountain:4|64|0.1|concurrent")


def test_what_is_said_of_a_point_has_units(opened: Any, report: Path) -> None:
    found = opened(report)
    found.draw_all()
    said = {
        figure: found.page.locator(f"{figure} .chart").first.evaluate(
            "chart => chart.data.find(({hovertext}) => hovertext).hovertext[0]"
        )
        for figure in ("#makespan", "#peak-bytes", "#accounts-by-policy", "#point")
    }
    assert re.search(r"at 5 % of the scene: [\d.]+( \(.*\))? (s|ms|us)$", said["#makespan"])
    assert re.search(r": [\d.]+( \(.*\))? k?B$", said["#peak-bytes"])
    assert re.search(r"at 5 % of the scene: [\d.]+ %$", said["#accounts-by-policy"])
    assert said["#point"].endswith(" %")


def test_a_point_in_depth_shows_the_accounts_of_the_rows(
    opened: Any, report: Path, rows: list[Row]
) -> None:
    points = points_of(rows, ())
    limits = limits_of_points(Folder(report.parent, rows), points)
    number = number_of(points, **CHOSEN)
    page = opened(report).page
    page.goto(f"{report.as_uri()}#point=mountain:4|64|0.1|concurrent")
    page.reload()
    chart = page.locator("#point-accounts")
    chart.locator(".main-svg").first.wait_for()
    for trace in chart.evaluate(
        "chart => chart.data.map(({name, x, customdata}) => ({name, x, customdata}))"
    ):
        expected = [100 * limits.shares(n)[trace["name"]] for n in trace["customdata"]]
        assert trace["x"] == pytest.approx(expected)
    chart = page.locator("#point-messages")
    for trace in chart.evaluate(
        "chart => chart.data.map(({name, x, customdata}) => ({name, x, customdata}))"
    ):
        assert trace["x"] == [points.messages(n)[trace["name"]] for n in trace["customdata"]]
    table = cells(page, "#point-policies")
    place = points.places[points.groups[number]]
    assert sorted(table[""]) == sorted(words.policy(points.profits[n]["policy"]) for n in place)
    mean = points.profits[number]["time_profit"]
    at = table[""].index("concurrent dataflow")
    assert table["time profit (95 % interval)"][at].startswith(f"{mean:.4g}")


def test_a_point_is_chosen_with_the_keyboard(opened: Any, report: Path) -> None:
    page = opened(report).page
    title = page.locator("#point-title")
    before = title.inner_text()
    page.locator("#place").focus()
    page.keyboard.press("ArrowDown")
    page.locator("#policy").focus()
    page.keyboard.press("ArrowUp")
    assert before == "<i>scene</i>, 8 PEs, x = 10 %: replicated scene"  # gains most
    assert title.inner_text() == "<i>scene</i>, 8 PEs, x = 50 %: concurrent dataflow"


def test_curves_are_hidden_and_the_theme_is_changed_with_the_keyboard(
    opened: Any, report: Path
) -> None:
    page = opened(report, theme="dark").page
    page.locator("#time-profit .main-svg").first.wait_for()
    button = page.locator("#time-profit .legend button").nth(1)
    button.focus()
    page.keyboard.press("Enter")
    assert button.get_attribute("aria-pressed") == "false"
    look = """chart => chart.data.filter(({mode}) => mode.includes('markers'))
                                .map(({visible, line}) => [visible, line.color])"""
    chart = page.locator("#time-profit .chart").first
    dark = chart.evaluate(look)
    assert [visible for visible, _ in dark] == [True, False, True, True, True]
    page.locator("#theme").focus()
    page.keyboard.press("Enter")
    light = chart.evaluate(look)
    assert all(one != other for (_, one), (_, other) in zip(dark, light, strict=True))
    page.reload()  # the choice is kept
    assert page.evaluate("document.documentElement.dataset.theme") == "light"


def test_labels_are_shown_as_they_are(opened: Any, report: Path) -> None:
    page = opened(report).page
    assert page.evaluate("window.hacked") is None
    assert HOSTILE in page.locator("#time-profit .legend button").all_inner_texts()
    assert HOSTILE in cells(page, "#point-policies")[""]
    panel = page.locator("#time-profit .panel").first
    assert panel.locator("h4").inner_text() == "<i>scene</i>"
    chart = page.locator("#point-accounts")
    chart.scroll_into_view_if_needed()
    chart.locator(".ytick text").first.wait_for()
    assert HOSTILE in chart.locator(".ytick text").all_text_contents()


def test_everything_is_on_paper(opened: Any, report: Path, tmp_path: Path) -> None:
    """Charts far below the window too, in the light theme, none wider than the paper."""
    found = opened(report, theme="dark")
    found.page.pdf(path=tmp_path / "report.pdf")
    found.page.emulate_media(media="print")
    count, folded = found.page.locator(".chart").count(), "details:not([open]) .chart"
    shown = count - found.page.locator(folded).count()  # what is folded stays so on paper
    assert 0 < shown < count
    assert found.page.locator(".chart .main-svg").count() >= 3 * shown
    assert not found.page.locator("nav").is_visible()


def test_two_sweeps_lie_over_each_other(opened: Any, comparison: Path) -> None:
    page = opened(comparison).page
    chart = page.locator("#time-profit .chart").first
    chart.locator(".main-svg").first.wait_for()
    modes = chart.evaluate("chart => chart.data.map(({mode}) => mode)")
    assert modes == ["lines"] * 5 + ["lines+markers"] * 5
    assert page.locator("#changes tr.sure").count() > 0


def test_the_page_of_a_running_sweep_reloads_itself(
    opened: Any, tmp_path: Path, rows: list[Row]
) -> None:
    def write(number: int, *, is_running: bool) -> Path:
        written(tmp_path, rows[:number])
        return write_page(report_of(read_folder(tmp_path)), is_running=is_running)

    found = opened(write(60, is_running=True))
    page = found.page
    assert page.locator(".live").inner_text() == "running: 60 of 60 rows done"
    page.locator("#place").select_option(index=1)
    page.locator("#place").blur()
    assert page.locator("#point-title").inner_text() == "x = 10 %: replicated scene"
    write(len(rows), is_running=False)
    page.locator(".live").wait_for(state="detached")
    title = "mountain:4, 8 PEs, x = 10 %: replicated scene"
    page.locator("#point-title", has_text=title).wait_for()
    asked = len(found.asked)
    page.wait_for_timeout(6000)  # longer than a running page waits
    assert len(found.asked) == asked
