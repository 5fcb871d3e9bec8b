"""Calling the commands as a user does, in a folder and with a cache of one's own."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from simmpp.cli import main
from simmpp.common.cache import cache_folder

COMPILED = os.environ.get("NUMBA_CACHE_DIR") or str(cache_folder() / "compiled")
"""Compiled code is shared with the other tests; workloads are not."""


def begin_in(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Go to the folder, and let nothing be traced before."""
    monkeypatch.chdir(folder)
    monkeypatch.setenv("SIMMPP_CACHE", str(folder / "cache"))
    monkeypatch.setenv("NUMBA_CACHE_DIR", COMPILED)


def simmpp(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments)


def refused(*arguments: str) -> str:
    """The one line of a command that exits with 2, without what all such lines begin with."""
    done = simmpp(*arguments)
    assert (done.exit_code, done.stdout) == (2, ""), done.output
    (line,) = done.stderr.splitlines()
    start, _, message = line.partition("simmpp: error: ")
    assert start == ""
    return message
