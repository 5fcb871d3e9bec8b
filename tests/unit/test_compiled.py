"""Compiled code is kept where its source says, or nowhere."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

import simmpp
from simmpp import compiled

PACKAGE = Path(simmpp.__file__).parent
PROGRAM = """
from simmpp.compiled import keeps_code
from simmpp.machine.network import transfer_ps
print(keeps_code(), transfer_ps(128, 256_000_000))
"""


def kept_beside_the_source() -> set[Path]:
    return set(PACKAGE.rglob("*.nbi"))


def test_nothing_is_kept_where_nothing_can_be_written(tmp_path: Path) -> None:
    before = kept_beside_the_source()
    not_a_folder = tmp_path / "file"
    not_a_folder.touch()
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    environment |= {"SIMMPP_CACHE": str(not_a_folder / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["False", "500000"]
    assert kept_beside_the_source() == before


def test_the_digest_covers_what_a_module_imports(monkeypatch: pytest.MonkeyPatch) -> None:
    read = compiled._source
    before = {
        name: compiled.source_digest(name) for name in ("simmpp.engine.sending", "simmpp.units")
    }

    def edited(module: str) -> str:
        return read(module) + ("# edited" if module == "simmpp.machine.network" else "")

    monkeypatch.setattr(compiled, "_source", edited)
    assert compiled.source_digest("simmpp.engine.sending") != before["simmpp.engine.sending"]
    assert compiled.source_digest("simmpp.units") == before["simmpp.units"]


def test_other_packages_keep_their_own_folder() -> None:
    before = numba.config.CACHE_DIR
    compiled.njit(lambda x: x)
    assert before == numba.config.CACHE_DIR
