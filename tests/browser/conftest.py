"""A real browser, which opens pages from disk and may ask nobody for anything; the pages."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from sweep_rows import HOSTILE, failed, row, sweep, written

from simmpp.common.files import Row, write_csv
from simmpp.common.folders import SWEEP, claimed, note_call
from simmpp.report.page.comparison import write_comparison
from simmpp.report.page.folder import Folder, read_folder
from simmpp.report.page.report import report_of, write_page
from simmpp.report.page.together import together
from simmpp.studies.bench.errors import bench_columns

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

QUIET = (
    "--no-sandbox",  # Chromium refuses to run as root otherwise, as in containers
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
POLICIES = ("object", "ray", "concurrent", "replicated", HOSTILE)
AXES: dict[str, Any] = {
    "scene": ["mountain:4", "<i>scene</i>"],
    "processors": [8, 64],
    "fraction": [0.05, 0.1, 0.5, 1.0],
}
REPRODUCED = Path(__file__).parents[2] / "experiments" / "nebel98" / "plain"
SCREENSHOTS = "SIMMPP_SCREENSHOTS"
"""Environment variable: a folder for what the pages look like."""


@dataclass
class Opened:
    """A page with all that it said and asked for."""

    page: Page
    said: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)

    def width_beyond_window(self) -> int:
        """Pixels that would have to be scrolled to the right."""
        root = "document.documentElement"
        return int(self.page.evaluate(f"{root}.scrollWidth - {root}.clientWidth"))

    def draw_all(self) -> None:
        """Scroll through the page until each chart is drawn, what is folded as well."""
        self.page.locator("details").evaluate_all("all => all.forEach(one => one.open = true)")
        for chart in self.page.locator(".chart").all():
            chart.scroll_into_view_if_needed()
            chart.locator(".main-svg").first.wait_for()

    def violations(self) -> list[str]:
        """What axe finds: rules of accessibility that the page breaks, and where."""
        from axe_playwright_python.sync_playwright import Axe

        found = Axe().run(self.page).response["violations"]
        return [f"{rule['id']}: {node['html']}" for rule in found for node in rule["nodes"]]

    def keep(self, name: str) -> None:
        """Take a picture of it, if a folder is given."""
        if folder := os.environ.get(SCREENSHOTS):
            self.page.screenshot(path=Path(folder) / f"{name}.png", full_page=True)


Opener = Callable[..., Opened]


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Debian's Chromium; a missing one is an error, as these tests are run on purpose."""
    from playwright.sync_api import sync_playwright  # of no use to other tests

    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found is None:
        pytest.fail("there is no chromium: apt-get install chromium")
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=found, args=list(QUIET))
        yield started
        started.close()


@pytest.fixture
def opened(browser: Browser) -> Iterator[Opener]:
    """Opens a page of a width, in a theme; in the end it has said and asked for nothing."""
    pages: list[Opened] = []

    def opening(path: Path, width: int = 1600, theme: str = "light") -> Opened:
        context = browser.new_context(
            viewport={"width": width, "height": 844},
            color_scheme=theme,  # type: ignore[arg-type]
            has_touch=width < 500,
        )
        made = Opened(context.new_page())
        made.page.on("console", lambda message: made.said.append(message.text))
        made.page.on("pageerror", lambda error: made.said.append(str(error)))
        made.page.on("request", lambda request: made.asked.append(request.url))
        pages.append(made)
        made.page.goto(path.as_uri())
        made.page.locator(".chart[role=img]").first.wait_for(state="attached")
        return made

    yield opening
    for made in pages:
        allowed = ("file:", "data:", "blob:")
        assert [url for url in made.asked if not url.startswith(allowed)] == []
        assert made.said == []
        made.page.context.close()


def page_of(folder: Path) -> Path:
    return write_page(report_of(read_folder(folder)))


@pytest.fixture(scope="session")
def rows() -> list[Row]:
    return [*sweep(POLICIES, **AXES), failed("late", 0)]


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory, rows: list[Row]) -> Path:
    return page_of(written(tmp_path_factory.mktemp("sweep"), rows))


@pytest.fixture(scope="session")
def comparison(tmp_path_factory: pytest.TempPathFactory, rows: list[Row]) -> Path:
    base = tmp_path_factory.mktemp("compared")
    slower = [r | {"makespan_ps": r["makespan_ps"] + 10**9} if not r["error"] else r for r in rows]
    folders = {
        name: read_folder(written(base / name, each))
        for name, each in (("before", rows), ("after", slower[:-40]))
    }
    page = base / "compare.html"
    write_comparison(folders, page)
    return page


@pytest.fixture(scope="session")
def folders(tmp_path_factory: pytest.TempPathFactory, rows: list[Row]) -> dict[str, Folder]:
    """Three, of which one is half a sweep; the command that goes on is a long one."""
    base, found = tmp_path_factory.mktemp("folders"), {}
    for times, name in enumerate(("as it is", "slow", "slower"), 1):
        own = [r | {"makespan_ps": times * r["makespan_ps"]} if not r["error"] else r for r in rows]
        with claimed(base / name, SWEEP):
            long = "simmpp sweep configs/sweep.yaml --set memory.fraction='[0.1, 0.2, 0.5]' --out "
            note_call(base / name, long + "results/" + 8 * "x")
        record = {"simulations": 3000, "finished": 2000 if times == 2 else 3000, "failed": 0}
        (base / name / "run.json").write_text(json.dumps(record))
        found[name] = read_folder(written(base / name, own))
    return found


@pytest.fixture(scope="session")
def several(folders: dict[str, Folder], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_page(report_of(together(folders, tmp_path_factory.mktemp("several"))))


@pytest.fixture(scope="session")
def comparisons(folders: dict[str, Folder], tmp_path_factory: pytest.TempPathFactory) -> Path:
    page = tmp_path_factory.mktemp("comparisons") / "compare.html"
    write_comparison(folders, page)
    return page


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One seed at one place, and pictures of it."""
    folder = written(tmp_path_factory.mktemp("run"), [row(policy) for policy in POLICIES[:4]])
    pictures = Path(__file__).parents[2] / "experiments" / "motion"
    (folder / "figures").mkdir()
    for name in ("concurrent-activity.png", "concurrent-progress.png"):
        shutil.copy(pictures / name, folder / "figures")
    return page_of(folder)


@pytest.fixture(scope="session")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    keys = ("scene", "processors", "fraction")
    measured = [
        dict.fromkeys(bench_columns(keys), 0.1 / seeds)
        | {"scene": "tetra:5", "processors": 64, "fraction": x, "policy": "concurrent"}
        | {"method": "simulate", "seeds": seeds, "groups": 2, "reference_seeds": 32 - seeds}
        for seeds in (1, 2, 4)
        for x in (0.1, 0.5)
    ]
    folder = tmp_path_factory.mktemp("bench")
    write_csv(measured, bench_columns(keys), folder / "bench.csv")
    return page_of(folder)


@pytest.fixture(scope="session")
def reproduction(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The paper's claims, and the rows of one of its figures."""
    folder = tmp_path_factory.mktemp("reproduction")
    for name in ("claims.csv", "figure2.csv", "rings7.csv"):
        shutil.copy(REPRODUCED / name, folder)
    return page_of(folder)
