"""A real browser, which opens pages from disk and may ask nobody for anything."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

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
        """Scroll through the page until each chart is drawn."""
        for chart in self.page.locator(".chart").all():
            chart.scroll_into_view_if_needed()
            chart.locator(".main-svg").first.wait_for()

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
