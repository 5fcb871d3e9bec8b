"""Tables of the page: sorted, filtered, downloaded, and what leads to their rows."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from sweep_rows import HOSTILE, row, written

from simmpp.common.files import Row
from simmpp.report.page.folder import read_folder
from simmpp.report.page.report import report_of, write_page
from simmpp.sweeps.winners.points import points_of

TABLE = "#all-points"
EMPTY = "\u2013"


def column(page: Any, name: str) -> list[str]:
    """The cells under a header."""
    return page.locator(TABLE).evaluate(
        """(table, name) => {
            const heads = [...table.tHead.rows[0].cells].map((cell) => cell.textContent);
            const at = heads.indexOf(name);
            return [...table.tBodies[0].rows].map((row) => row.cells[at].textContent);
        }""",
        name,
    )


def downloaded(page: Any, name: str) -> tuple[str, list[list[str]]]:
    """A file's name and rows."""
    with page.expect_download() as download:
        page.get_by_role("button", name=name).click()
    text = Path(download.value.path()).read_text(encoding="utf-8-sig")
    return download.value.suggested_filename, list(csv.reader(text.splitlines()))


def test_a_header_sorts_up_down_and_back(opened: Any, report: Path) -> None:
    page = opened(report).page
    before = column(page, "makespan")
    header = page.locator(f"{TABLE} th", has_text="makespan")
    assert header.get_attribute("aria-sort") is None
    header.locator("button").focus()
    page.keyboard.press("Enter")
    assert header.get_attribute("aria-sort") == "ascending"
    known = [text for text in column(page, "makespan") if text != EMPTY]
    milliseconds = [float(n) * {"s": 1e3, "ms": 1}[unit] for n, unit in map(str.split, known)]
    assert milliseconds == sorted(milliseconds)
    assert known != sorted(known)  # as texts seconds come between milliseconds
    page.keyboard.press("Space")
    assert header.get_attribute("aria-sort") == "descending"
    assert [text for text in column(page, "makespan") if text != EMPTY] == known[::-1]
    page.keyboard.press("Enter")
    assert header.get_attribute("aria-sort") is None
    assert column(page, "makespan") == before


def test_what_is_empty_comes_last_both_ways(opened: Any, tmp_path: Path) -> None:
    rows = [row("object"), row("ray") | {"messages": ""}, row("concurrent")]
    page = opened(write_page(report_of(read_folder(written(tmp_path, rows))))).page
    for _ in range(2):
        page.locator(f"{TABLE} th button", has_text="messages").first.click()
        assert column(page, "messages")[-1] == EMPTY


def test_a_filter_leaves_the_rows_that_have_all_its_words(opened: Any, report: Path) -> None:
    page = opened(report).page
    whole = len(column(page, "policy"))
    page.locator("#rows input").fill("5 % Concurrent 8 mountain:4")
    assert set(column(page, "policy")) == {"concurrent dataflow"}
    assert set(column(page, "scene")) == {"mountain:4"}
    shown = len(column(page, "policy"))
    assert page.locator("#rows output").inner_text() == f"{shown} of {whole} rows"
    page.locator("#rows input").fill("")
    assert len(column(page, "policy")) == whole


def test_what_is_shown_becomes_a_file(opened: Any, report: Path, rows: list[Row]) -> None:
    page = opened(report).page
    page.locator("#rows input").fill("hacked 64 mountain:4")
    page.locator(f"{TABLE} th button", has_text="x").first.click()
    name, (header, *points) = downloaded(page, "CSV of points: All points")
    assert name.endswith("all-points-of-points.csv")
    known = points_of(rows, ())
    found = [dict(zip(header, each, strict=True)) for each in points]
    assert [each["fraction"] for each in found] == ["0.05", "0.1", "0.5", "1"]
    assert {each["policy"] for each in found} == {HOSTILE}
    for each in found:
        keys = {"scene": "mountain:4", "processors": 64, "fraction": float(each["fraction"])}
        (expected,) = (
            p for p in known.profits if p.items() >= (keys | {"policy": HOSTILE}).items()
        )
        assert float(each["time_profit_low"]) == round(expected["time_profit_low"], 9)
    _, (header, *runs) = downloaded(page, "CSV of their rows, seed by seed: All points")
    assert len(runs) == 3 * len(points)
    assert int(dict(zip(header, runs[1], strict=True))["rays"]) == 2**60 + 1


def test_other_tables_sort_too(opened: Any, comparison: Path) -> None:
    page = opened(comparison).page
    header = page.locator("#changes th", has_text="change").first
    header.locator("button").click()
    changes = page.locator("#changes td:nth-child(5)").all_inner_texts()
    per_cent = [float(text.split()[0]) for text in changes]
    assert per_cent == sorted(per_cent)


def test_a_figure_leads_to_its_rows(opened: Any, report: Path) -> None:
    page = opened(report).page
    page.locator("#time-profit select").select_option("64 PEs")
    page.locator("#time-profit a.rows").click()
    assert set(column(page, "PEs")) == {"64"}
    assert page.locator("#only").inner_text().startswith("Only those of “Time profit”")
    page.locator("#only button").click()
    assert set(column(page, "PEs")) == {"8", "64"}
    assert not page.locator("#only").is_visible()


def test_a_row_leads_to_its_point_however_rows_are_sorted(opened: Any, report: Path) -> None:
    page = opened(report).page
    page.locator(f"{TABLE} th button", has_text="speed-up").click()
    link = page.locator(f"{TABLE} tbody a[aria-label='mountain:4, 64 PEs, x = 10 %: ray dataflow']")
    link.click()
    title = page.locator("#point-title", has_text="mountain:4, 64 PEs, x = 10 %: ray dataflow")
    title.wait_for()
    assert unquote(page.url).endswith("#point=mountain:4|64|0.1|ray")


def test_a_sentence_leads_to_the_rows_that_say_so(opened: Any, report: Path) -> None:
    page = opened(report).page
    sentence = page.locator("#summary li", has_text="Ray dataflow: time profit").first
    sentence.locator("a.rows").click()
    gains = column(page, "time profit")
    assert set(column(page, "policy")) == {"ray dataflow"}
    assert all(gain[:4] in sentence.inner_text() for gain in gains)
    assert page.locator("#only").inner_text().startswith("Only those of “Ray dataflow: time profit")


def test_the_rows_of_a_point_are_a_file_too(opened: Any, report: Path) -> None:
    page = opened(report).page
    page.locator("#place").select_option(index=1)
    _, table = downloaded(page, "CSV: Rows of the chosen point")
    cells = {first: others for first, *others in table}
    assert cells["seed"] == ["0", "1", "2"]
    assert cells["rays"] == [str(2**60 + seed) for seed in range(3)]
