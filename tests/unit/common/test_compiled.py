"""Compiled code is kept where its source says, or nowhere."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import numba
import pytest

import simmpp
from simmpp.common import compiled, modules

PACKAGE = Path(simmpp.__file__).parent
PROGRAM = """
from simmpp.common.compiled import keeps_code
from simmpp.machine.transfer import transfer_ps
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
        name: compiled.source_digest(name)
        for name in ("simmpp.engine.pe.sending", "simmpp.common.units")
    }

    def edited(module: str) -> str:
        return read(module) + ("# edited" if module == "simmpp.machine.transfer" else "")

    monkeypatch.setattr(compiled, "_source", edited)
    assert compiled.source_digest("simmpp.engine.pe.sending") != before["simmpp.engine.pe.sending"]
    assert compiled.source_digest("simmpp.common.units") == before["simmpp.common.units"]


def test_the_digest_covers_modules_imported_from_a_package_and_within_functions() -> None:
    imported = compiled._closure("simmpp.workload.trace.geometry")
    assert "simmpp.workload.trace.bvh" in imported  # from simmpp.workload import bvh
    assert "simmpp.config.config" in compiled._closure("simmpp.commands.run")  # in a function
    assert "simmpp.engine.result" not in compiled._closure("simmpp")  # for type checkers only


@pytest.mark.parametrize("module", ["simmpp.no_such_module", "simmpp.workload.nothing"])
def test_a_module_without_a_file_has_no_digest(module: str) -> None:
    with pytest.raises(ModuleNotFoundError, match=module):
        compiled.source_digest(module)


@pytest.mark.parametrize("module", modules.NAMED_MODULES)
def test_modules_named_by_a_string_are_there(module: str) -> None:
    assert importlib.util.find_spec(module)
    assert len(compiled.source_digest(module)) == 16


def test_no_other_file_names_a_module_by_a_string() -> None:
    named = re.compile(r"""["'](simmpp\.[a-z_.]+)["']""")
    for file in PACKAGE.rglob("*.py"):
        if file not in (PACKAGE / "common" / "modules.py", PACKAGE / "__init__.py"):
            assert not named.findall(file.read_text(encoding="utf-8")), file


def test_other_packages_keep_their_own_folder() -> None:
    before = numba.config.CACHE_DIR
    compiled.njit(lambda x: x)
    assert before == numba.config.CACHE_DIR
