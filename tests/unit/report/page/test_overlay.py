"""Curves of a check over those of its baseline: both are there, whatever moved."""

from __future__ import annotations

from pathlib import Path

from sweep_rows import sweep

from simmpp.report.page.overlay import NOTE, overlay
from simmpp.sweeps.profits import profit_rows


def cells(**axes: list[object]) -> list[dict[str, str]]:
    """Rows of profits.csv as they are read."""
    return [{name: str(cell) for name, cell in row.items()} for row in profit_rows(sweep(**axes))]


def test_old_and_new_points_are_drawn_for_each_scene(tmp_path: Path) -> None:
    before = cells(scene=["tetra:3", "rings:1"], fraction=[0.1, 0.5, 0.8])
    now = cells(scene=["tetra:3", "balls:2"], fraction=[0.1, 0.5, 0.9])
    png, svg = overlay(before, now, tmp_path / "profits")
    assert png.read_bytes().startswith(b"\x89PNG")
    text = svg.read_text(encoding="utf-8")
    for scene in ("tetra:3", "rings:1", "balls:2"):
        assert f"Time profit: {scene}" in text
        assert f"Message profit: {scene}" in text
    assert NOTE in text


def test_points_that_all_failed_leave_the_baseline(tmp_path: Path) -> None:
    before = cells(fraction=[0.1, 0.5, 0.8])
    now = [
        row | {"n": "0"} | dict.fromkeys(("time_profit", "message_profit"), "") for row in before
    ]
    _, svg = overlay(before, now, tmp_path / "profits")
    assert "concurrent dataflow" in svg.read_text(encoding="utf-8")


def test_only_what_moved_is_drawn(tmp_path: Path) -> None:
    before = cells(scene=["tetra:3", "rings:1"], fraction=[0.1, 0.5, 0.8])
    now = [dict(row) for row in before]
    assert overlay(before, now, tmp_path / "profits") == []
    assert list(tmp_path.iterdir()) == []
    moved = next(r for r in now if r["scene"] == "rings:1" and r["policy"] == "ray")
    moved["time_profit"] = f"{float(moved['time_profit']) * 1.01}"
    _, svg = overlay(before, now, tmp_path / "profits")
    text = svg.read_text(encoding="utf-8")
    assert "Time profit: rings:1" in text
    assert "Message profit" not in text
    assert "tetra:3" not in text
