"""A sweep is watched: its tables are there while it runs, and its page ends with it."""

from __future__ import annotations

from pathlib import Path

import pytest
from sweep_rows import sweep, written

from simmpp.common.folders import held
from simmpp.report.page import report as live
from simmpp.sweeps import sweep as running
from simmpp.sweeps import sweep as showing
from simmpp.sweeps.journal import Outcome


def test_the_page_is_written_again_until_the_sweep_is_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live, "LOOK_S", 0.01)
    rows = sweep(fraction=[0.1, 0.5, 1.0])
    page = tmp_path / "report.html"
    with held(tmp_path):
        pages = live.follow(written(tmp_path, rows[:12]))
        assert len(next(pages).rows) == 12
        assert "running: 12 of 12 rows done" in page.read_text(encoding="utf-8")
        written(tmp_path, rows[:24])
        assert len(next(pages).rows) == 24
        written(tmp_path, rows)
    assert len(next(pages).rows) == 36
    assert "running:" not in page.read_text(encoding="utf-8")
    assert list(pages) == []


def test_tables_are_there_while_a_sweep_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(showing, "SHOWN_S", 0.0)
    monkeypatch.setattr(showing, "SHARE", 0)
    lines = []

    class Looking(running.Watcher):
        def simulated(self, outcome: Outcome) -> None:
            lines.append((tmp_path / "results.csv").read_text().count("\n"))

    config = {
        "scene": {"spd": "tetra", "size": 2},
        "picture": {"resolution": 8},
        "sweep": {"processors": [2, 4, 8]},
        "policy": "ray",
    }
    running.run_sweep(config, out=tmp_path, watcher=Looking())
    assert lines == [1, 2, 3, 4, 5, 6]  # the header, and the rows of the simulations before


def test_writing_tables_takes_no_more_than_its_share(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s, written_at = 0.0, []

    def write() -> None:
        nonlocal now_s
        written_at.append(now_s)
        now_s += 1.0

    monkeypatch.setattr(showing.time, "monotonic", lambda: now_s)
    shown = showing.Showing(write)
    for _ in range(60):
        now_s += 0.5
        shown()
    assert written_at == [0.0, 6.0, 27.0]  # 5 s after the first, then 20 times the second it took
