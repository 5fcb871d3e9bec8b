"""The page of a sweep while it runs: written again whenever its tables are."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

from simmpp.report.page.folder import Folder, read_folder
from simmpp.report.page.report import report_of, write_page
from simmpp.sweeps.journal import is_at_work
from simmpp.sweeps.sweep import RESULTS

LOOK_S = 1.0
"""Seconds between two looks at the tables."""


def follow(path: Path) -> Iterator[Folder]:
    """Write the page of what is there, again and again; ends when no sweep works there any more.

    Yields what each page shows; the last one reloads itself no more.
    """
    seen = None
    while is_at_work(path):
        results = path / RESULTS
        written = results.stat().st_mtime_ns if results.is_file() else None
        if written is not None and written != seen:
            seen = written
            yield _write(path, is_running=True)
        time.sleep(LOOK_S)
    yield _write(path, is_running=False)


def _write(path: Path, *, is_running: bool) -> Folder:
    folder = read_folder(path)
    write_page(report_of(folder), is_running=is_running)
    return folder
