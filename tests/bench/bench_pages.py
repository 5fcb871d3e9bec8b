"""What a page takes, and its figures and the pictures of a run as PNG and SVG.

    python tests/bench/bench_pages.py [DIR]

DIR is what ``simmpp report`` makes a page of, experiments/nebel98/plain without it; the run is that
of configs/quick.yaml. CPU seconds in one process, of drawings the best of two: as simmpp draws,
and as ``Figure.savefig`` does, which lays out and draws each file for itself.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from unittest.mock import patch

from matplotlib.figure import Figure
from PIL import Image, ImageChops

from simmpp.config.config import load_config
from simmpp.engine.record.recording import Recording
from simmpp.plot import matplotlib_panels
from simmpp.report.page.figures.stills import stills_of
from simmpp.report.page.folder import read_folder
from simmpp.report.page.report import report_of, write_page
from simmpp.report.run_figures import drawing
from simmpp.report.run_figures.data import motion_of
from simmpp.run.inputs import workload_of
from simmpp.run.point import make_point, run_point

ROOT = Path(__file__).parents[2]
Draw = Callable[[Path], list[Path]]
"""Writes the files of one figure into a folder."""


def main(folder: Path = ROOT / "experiments" / "nebel98" / "plain") -> None:
    """Print the times."""
    began_s = time.process_time()
    report = report_of(read_folder(folder))
    with tempfile.TemporaryDirectory() as elsewhere:
        page = write_page(replace(report, folder=replace(report.folder, path=Path(elsewhere))))
        size_mb = page.stat().st_size / 1e6
    print(f"{page.name}: {time.process_time() - began_s:.2f} s, {size_mb:.1f} MB")
    stills = stills_of(report.figures, [next(iter(f.files.values())) for f in report.figures])
    compare(
        f"figures of the page, {sum(len(still.panels) for still in stills)} panels",
        [lambda to, s=still: matplotlib_panels.draw(s.panels, to / s.stem) for still in stills],
    )
    compare("pictures of a run", list(pictures(ROOT / "configs" / "quick.yaml")))


def pictures(path: Path) -> Iterator[Draw]:
    """Those of each policy."""
    config = load_config(path)
    point = make_point(config, workload_of(config))
    for run in run_point(point, record=Recording(counters=True, hops=True)):
        motion = motion_of(point, run, None)
        for name in motion.pictures:
            yield partial(drawing.draw_picture, name, motion)


def compare(what: str, draws: Sequence[Draw]) -> None:
    """Both ways of drawing, and whether they look the same."""
    with tempfile.TemporaryDirectory() as folder:
        ours, theirs = Path(folder, "ours"), Path(folder, "theirs")
        once_s = best_of_two(draws, ours)
        settings = matplotlib_panels.SETTINGS | {"axes.titley": None}
        with (
            patch.object(matplotlib_panels, "save", savefig),
            patch.object(drawing, "save", savefig),
            patch.object(matplotlib_panels, "SETTINGS", settings),
            patch.object(drawing, "SETTINGS", settings),
        ):
            twice_s = best_of_two(draws, theirs)
        equal = sum(looks_like(png, theirs / png.name) for png in ours.glob("*.png"))
        kb = [sum(png.stat().st_size for png in to.glob("*.png")) / 1e3 for to in (ours, theirs)]
    print(f"{what}: {len(draws)}, PNG and SVG")
    print(f"  CPU seconds each: drawn {once_s:.2f}, by savefig {twice_s:.2f}")
    print(f"  kB of a PNG: {kb[0] / len(draws):.0f}, by savefig {kb[1] / len(draws):.0f}")
    print(f"  {equal} of {len(draws)} PNGs are equal in each pixel")


def best_of_two(draws: Sequence[Draw], to: Path) -> float:
    """CPU seconds of a figure: the second time what is loaded once, as fonts, is there."""
    to.mkdir()
    times_s = []
    for _ in range(2):
        began_s = time.process_time()
        for draw in draws:
            draw(to)
        times_s.append(time.process_time() - began_s)
    return min(times_s) / len(draws)


def looks_like(one: Path, other: Path) -> bool:
    """They have the same pixels."""
    pixels = [Image.open(path).convert("RGB") for path in (one, other)]
    return ImageChops.difference(*pixels).getbbox() is None


def savefig(figure: Figure, stem: Path) -> list[Path]:
    """As matplotlib saves figures."""
    png, svg = (stem.with_name(f"{stem.name}.{kind}") for kind in ("png", "svg"))
    figure.savefig(png, dpi=matplotlib_panels.DOTS_PER_INCH)
    figure.savefig(svg, metadata={"Date": None})
    return [png, svg]


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
