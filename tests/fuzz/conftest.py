"""Fuzzing leaves nothing behind: files and workloads go where the test's own folder is."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from fuzzing import TRIED

from simmpp.common.compiled import cache_folder

COMPILED = os.environ.get("NUMBA_CACHE_DIR") or str(cache_folder() / "compiled")
"""Compiled code is shared with the other tests."""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SIMMPP_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("NUMBA_CACHE_DIR", COMPILED)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """How many examples the readers were tried with."""
    if TRIED:
        terminalreporter.section("fuzz")
    for name in sorted(TRIED):
        terminalreporter.line(f"{TRIED[name]:6} {name}")
