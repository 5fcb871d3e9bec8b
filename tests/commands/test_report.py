"""The commands report and compare: what they write, print and refuse."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

import pytest
from click.testing import CliRunner
from rich.console import Console
from rich.progress import Progress, TextColumn
from sweep_rows import failed, row, sweep, written

from simmpp.cli import main
from simmpp.commands.parts.progress import BarWatcher


def run(*arguments: object) -> tuple[int, str]:
    done = CliRunner().invoke(main, [str(each) for each in arguments])
    assert done.exception is None or isinstance(done.exception, SystemExit), done.output
    return done.exit_code, done.output


def test_report_writes_the_page_alone(tmp_path: Path) -> None:
    folder = written(tmp_path, [row(), row("ray"), failed("late")])
    before = set(folder.iterdir())
    code, told = run("report", folder)
    assert code == 0
    assert "report.html: 3 rows, 4." in told
    assert set(folder.iterdir()) - before == {folder / "report.html"}


def test_report_draws_the_figures_that_are_named(tmp_path: Path) -> None:
    folder = written(tmp_path, [row(), row("ray"), failed("late")])
    figures = folder / "figures"
    code, told = run("report", folder, "--figures", "time-profit", "--figures", "messages-by-kind")
    assert code == 0
    assert told.endswith("figures: 2 figures, as PNG and SVG\n")
    assert {path.stem for path in figures.iterdir()} == {"time-profit", "messages-by-kind"}
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "figures/time-profit.svg" in page
    assert "figures/message-profit.svg" not in page
    code, told = run("report", folder, "--figures", "all")
    assert (code, "figures: 6 figures, as PNG and SVG" in told) == (0, True)
    curves = {"makespan", "time-profit", "peak-bytes", "message-profit"}
    stems = {*curves, "accounts-by-policy", "messages-by-kind"}
    assert {path.stem for path in figures.iterdir()} == stems
    assert len(list(figures.iterdir())) == 12


def test_report_refuses_unknown_figures_before_it_writes(tmp_path: Path) -> None:
    folder = written(tmp_path, [row(), row("ray")])
    code, told = run("report", folder, "--figures", "speedup", "--figures", "ray")
    curves = "makespan, time-profit, peak-bytes, message-profit"
    there = f"all, {curves}, accounts-by-policy, messages-by-kind"
    assert told == f"simmpp: error: --figures: values 'speedup', 'ray': expected {there}\n"
    assert code == 2
    assert not (folder / "report.html").exists()


def test_drawing_has_a_bar(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    screen, column = StringIO(), TextColumn("{task.description} {task.completed} of {task.total}")
    bars = Progress(column, console=Console(file=screen, force_terminal=True))
    monkeypatch.setattr("simmpp.commands.report.progress_bars", lambda: bars)
    run("report", written(tmp_path, [row(), row("ray")]), "--figures", "time-profit")
    assert "drawing 1 of 1" in screen.getvalue()


def test_reading_and_writing_have_a_bar(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    screen = StringIO()

    def bars() -> Progress:
        return Progress(
            TextColumn("{task.description}"), console=Console(file=screen, force_terminal=True)
        )

    monkeypatch.setattr("simmpp.commands.parts.terminal.progress_bars", bars)
    run("report", written(tmp_path, [row(), row("ray")]))
    assert "reading rows" in screen.getvalue()
    assert "writing the page" in screen.getvalue()


def test_studies_draw_with_a_bar_too() -> None:
    screen = StringIO()
    column = TextColumn("{task.description} {task.completed} of {task.total} {task.fields[more]}")
    with Progress(column, console=Console(file=screen, force_terminal=True)) as bars:
        watcher = BarWatcher(bars)
        watcher.drawing(0, 7)
        watcher.drawing(3, 7)
    assert "drawing 3 of 7 figures" in screen.getvalue()


def test_live_ends_at_once_where_no_sweep_works(tmp_path: Path) -> None:
    code, told = run("report", "--live", written(tmp_path, [row(), row("ray")]))
    assert code == 0
    assert "2 of 2 rows" in told
    assert 'class="live"' not in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("options", [(), ("--live",)])
def test_report_refuses_a_folder_without_rows(tmp_path: Path, options: tuple[str, ...]) -> None:
    code, told = run("report", *options, tmp_path)
    assert code == 2
    assert told.splitlines()[-1].startswith(f"simmpp: error: DIR: value '{tmp_path}': there are no")


def test_compare_exits_with_0_whatever_moved(tmp_path: Path) -> None:
    before = written(tmp_path / "before", sweep(fraction=[0.1, 1.0]))
    slower = [r | {"makespan_ps": 2 * r["makespan_ps"]} for r in sweep(fraction=[0.1, 0.5])]
    after = written(tmp_path / "after", slower)
    page = tmp_path / "page.html"
    code, told = run("compare", before, after, "--out", page)
    assert code == 0
    verdict = "4 points in both, 4 only before, 4 only after; 4 moved, 4 beyond the 95 % interval."
    assert told.splitlines()[-1] == f"compare: {verdict}"
    assert "x = 10 %, ray dataflow" in told
    assert "+100 %" in told
    assert "only after: x = 50 %, object dataflow" in told
    assert page.read_text(encoding="utf-8").startswith("<!doctype html>")


def test_compare_says_which_folder_it_can_not_read(tmp_path: Path) -> None:
    folder = written(tmp_path / "a", [row()])
    assert run("compare", folder, tmp_path / "b")[1].startswith("simmpp: error: AFTER: value")
    assert run("compare", tmp_path / "b", folder)[0] == 2
    code, told = run("compare", folder, folder, "--out", tmp_path / "page.txt")
    assert (code, "expected a file .html" in told) == (2, True)
