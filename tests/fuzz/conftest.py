"""Fuzzing leaves nothing behind: files and workloads go where the test's own folder is."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from fuzzing import TRIED

from simmpp.common.cache import cache_folder

COMPILED = os.environ.get("NUMBA_CACHE_DIR") or str(cache_folder() / "compiled")
"""Compiled code is shared with the other tests."""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SIMMPP_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("NUMBA_CACHE_DIR", COMPILED)


@pytest.fixture(autouse=True)
def tried(record_property: Callable[[str, object], None]) -> Iterator[None]:
    """The number of examples goes to the summary, whichever process ran the test."""
    TRIED.clear()
    yield
    if TRIED:
        record_property("tried", dict(TRIED))
