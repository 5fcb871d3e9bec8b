"""Half of a sweep is told as such, with how much there is and how to go on."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from sweep_rows import failed, row, sweep, written

from simmpp.common.files import Row
from simmpp.common.folders import SWEEP, claimed, held, note_call
from simmpp.report.page.folder import read_folder
from simmpp.report.page.report import report_of, write_page
from simmpp.report.page.standing import warnings_of

CALL = "simmpp sweep c.yaml --set 'seeds=[0, 1]'"


def folder(path: Path, rows: list[Row], call: str = CALL, **record: object) -> Path:
    with claimed(path, SWEEP):
        if call:
            note_call(path, call)
        (path / "run.json").write_text(json.dumps({"points": len(rows), **record}))
    return written(path, rows)


def warned(path: Path) -> list[str]:
    return [str(one) for one in warnings_of(read_folder(path))]


@pytest.mark.parametrize(
    ("counts", "lines"),
    [
        ((12, 12, 0), []),
        ((36, 12, 0), [f"interrupted: 12 of 36 simulations are in these tables; to go on: {CALL}"]),
        ((1, 0, 0), [f"interrupted: 0 of 1 simulation are in these tables; to go on: {CALL}"]),
    ],
)
def test_what_is_missing(tmp_path: Path, counts: tuple[int, ...], lines: list[str]) -> None:
    record = dict(zip(("simulations", "finished", "failed"), counts, strict=True))
    path = folder(tmp_path, sweep(fraction=[0.5]), **record)
    assert warned(path) == lines
    page = write_page(report_of(read_folder(path))).read_text(encoding="utf-8")
    assert ("Interrupted: " in page) == bool(lines)
    assert ("<code>simmpp sweep c.yaml --set &#39;seeds=[0, 1]&#39;</code>" in page) == bool(lines)


def test_what_failed_can_be_tried_again(tmp_path: Path) -> None:
    rows = [row(), failed("ray"), failed("late", 1) | {"error": "timeout: not finished after 5 s"}]
    done = {"simulations": 3, "finished": 1, "failed": 2}
    told = "2 rows failed: timeout: not finished after 5 s (and 1 other error)"
    assert warned(folder(tmp_path / "a", rows, **done)) == [f"{told}; to try again: {CALL}"]
    assert warned(folder(tmp_path / "b", rows, "", **done)) == [told]
    first, second = warned(folder(tmp_path / "c", rows, **done | {"simulations": 4}))
    assert first == f"interrupted: 3 of 4 simulations are in these tables; to go on: {CALL}"
    assert second == told


def test_a_sweep_that_adds_points_has_as_many_so_far(tmp_path: Path) -> None:
    counts = {"simulations": 8, "finished": 2, "failed": 0, "config": {"tolerance": "2%"}}
    (line,) = warned(folder(tmp_path, [row(), row("ray")], "", **counts))
    there = "interrupted: 2 of 8 simulations asked for so far are in these tables"
    assert line == f"{there}; to go on: the same call that made the folder"


def test_a_sweep_that_runs_can_be_followed(tmp_path: Path) -> None:
    path = folder(tmp_path / "a b", [row()], simulations=8, finished=1, failed=0)
    with held(path):
        (line,) = warned(path)
        assert warnings_of(read_folder(path), is_followed=True) == []
    assert line == (
        "a sweep runs here: 1 of 8 simulations are in these tables; to follow it: "
        f"simmpp report --live '{path}'"
    )


def test_elsewhere_the_command_says_where_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a b").mkdir()
    monkeypatch.chdir(tmp_path / "a b")
    path = folder(tmp_path / "o", [row()], points=4)
    assert warned(path)[0].endswith(f"1 of 4 rows are in these tables; to go on: {CALL}")
    monkeypatch.chdir(tmp_path)
    assert warned(path)[0].endswith(f"to go on: cd '{tmp_path}/a b' && {CALL}")
