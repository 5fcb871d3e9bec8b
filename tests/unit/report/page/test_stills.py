"""Figures as files: which are drawn, and that nothing depends on who draws them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from sweep_rows import sweep

from simmpp.common.errors import ConfigError
from simmpp.report.page.figures.figure import Figure
from simmpp.report.page.figures.stills import ALL, stills_of, write_stills
from simmpp.report.page.folder import Folder
from simmpp.report.page.report import report_of


@pytest.fixture(scope="module")
def figures() -> list[Figure]:
    rows = sweep(scene=["a b", "a-b"], fraction=[0.1, 0.5, 1.0], processors=[8, 16, 64])
    return report_of(Folder(Path(), rows)).figures


def test_names_are_those_of_figures_and_of_files(figures: list[Figure]) -> None:
    files = [stem for figure in figures for stem in figure.files.values()]
    assert [still.stem for still in stills_of(figures, [ALL])] == files
    for figure in figures:
        stems = list(figure.files.values())
        assert [still.stem for still in stills_of(figures, [figure.stem])] == stems
        assert [still.stem for still in stills_of(figures, [stems[-1], stems[-1]])] == stems[-1:]
    assert stills_of(figures, []) == []
    assert len(stills_of(figures, [files[0], ALL])) == len(files)


def test_all_names_that_are_unknown_are_told_at_once(figures: list[Figure]) -> None:
    with pytest.raises(ConfigError) as refused:
        stills_of(figures, ["speed-up", "speedup", "all of them", "speed-up"])
    there = ", ".join(figure.stem for figure in figures)
    told = f"--figures: values 'speed-up', 'all of them': expected all, {there}"
    assert str(refused.value) == told


def test_files_have_the_same_bytes_each_time_whoever_draws(
    figures: list[Figure], tmp_path: Path
) -> None:
    stills = stills_of(figures[:2], [ALL])[:3]
    drawn = []
    for run, workers in enumerate((1, 1, 2)):
        folder = tmp_path / str(run)
        paths = [path for pair in write_stills(stills, folder, workers) for path in pair]
        assert sorted(paths) == sorted(folder.iterdir())
        drawn.append({path.name: path.read_bytes() for path in paths})
    assert set(drawn[0]) == {f"{still.stem}.{kind}" for still in stills for kind in ("png", "svg")}
    assert drawn[0] == drawn[1] == drawn[2]


def test_what_can_not_be_written_is_told_by_who_asked(
    figures: list[Figure], tmp_path: Path
) -> None:
    stills = stills_of(figures[:1], [ALL])[:2]
    (tmp_path / f"{stills[0].stem}.png").mkdir()
    with pytest.raises(OSError):
        list(write_stills(stills, tmp_path, 2))


def test_a_page_needs_no_matplotlib() -> None:
    code = "import sys, simmpp.commands.report; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
