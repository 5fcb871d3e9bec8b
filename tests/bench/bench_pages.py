"""What a page takes, and a figure of it as PNG and SVG.

    python tests/bench/bench_pages.py [DIR]

DIR is what ``simmpp report`` makes a page of, experiments/nebel98 without it. CPU seconds in one
process; of figures the mean over the first plate of each, and the same with ``Figure.savefig``,
which draws each file twice; both have the same bytes.
"""

from __future__ import annotations

import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from matplotlib.figure import Figure

from simmpp.plot import matplotlib_panels
from simmpp.report.page.figures.stills import Still, stills_of
from simmpp.report.page.folder import read_folder
from simmpp.report.page.report import report_of, write_page

NEBEL98 = Path(__file__).parents[2] / "experiments" / "nebel98"


def main(folder: Path = NEBEL98) -> None:
    """Print the times."""
    began_s = time.process_time()
    report = report_of(read_folder(folder))
    with tempfile.TemporaryDirectory() as elsewhere:
        page = write_page(replace(report, folder=replace(report.folder, path=Path(elsewhere))))
        size_mb = page.stat().st_size / 1e6
    print(f"{page.name}: {time.process_time() - began_s:.2f} s, {size_mb:.1f} MB")
    stills = stills_of(report.figures, [next(iter(f.files.values())) for f in report.figures])
    draw_all(stills)  # what is loaded and kept once, as fonts and the sizes of texts
    once, files = draw_all(stills)
    matplotlib_panels.save = savefig
    twice, others = draw_all(stills)
    panels = sum(len(still.panels) for still in stills)
    print(f"{len(stills)} figures of {panels} panels, PNG and SVG, CPU seconds each:")
    print(f"drawn {once / len(stills):.2f}, by savefig {twice / len(stills):.2f}")
    print("the same bytes" if files == others else "DIFFERENT BYTES")


def draw_all(stills: list[Still]) -> tuple[float, list[bytes]]:
    """CPU seconds, and the files."""
    with tempfile.TemporaryDirectory() as folder:
        began_s = time.process_time()
        paths = [matplotlib_panels.draw(s.panels, Path(folder, s.stem)) for s in stills]
        return time.process_time() - began_s, [p.read_bytes() for pair in paths for p in pair]


def savefig(figure: Figure, stem: Path) -> list[Path]:
    """As matplotlib saves figures, titles placed by it."""
    png, svg = (stem.with_name(f"{stem.name}.{kind}") for kind in ("png", "svg"))
    for axes in figure.axes:
        axes.set_title(axes.get_title(), fontsize=9, y=None)
    figure.savefig(png, dpi=matplotlib_panels.DOTS_PER_INCH)
    figure.set_layout_engine("none")
    figure.savefig(svg, metadata={"Date": None})
    return [png, svg]


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
