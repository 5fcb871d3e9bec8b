"""Compiled code is kept where its source says, or nowhere."""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import pytest

import simmpp
from simmpp.common import compiled, modules
from simmpp.common.code.source import source_digest

PACKAGE = Path(simmpp.__file__).parent
PROGRAM = """
from simmpp.common.code.kept import keeps_code
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


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the package, to be edited."""
    folder = tmp_path_factory.mktemp("copy")
    shutil.copytree(PACKAGE, folder / "simmpp", ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def digest_in(folder: Path, module: str) -> str:
    code = f"from simmpp.common.code.source import source_digest; print(source_digest({module!r}))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=True
    )
    return done.stdout


def test_a_copy_of_the_package_finds_its_code(copy: Path, tmp_path: Path) -> None:
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    environment |= {"SIMMPP_CACHE": str(tmp_path)}
    hits = PROGRAM + "print(sum(transfer_ps.stats.cache_hits.values()))"
    printed = [
        subprocess.run(
            [sys.executable, "-c", hits], cwd=folder, env=environment, stdout=-1, check=True
        ).stdout.split()
        for folder in (PACKAGE.parent, copy)
    ]
    assert [each[-1] for each in printed] == [b"0", b"1"]


@pytest.mark.parametrize(
    ("edited", "module", "is_covered"),
    [
        ("machine/transfer.py", "simmpp.engine.pe.sending", True),
        ("machine/transfer.py", "simmpp.common.units", False),
        ("workload/trace/bvh.py", "simmpp.workload.trace.geometry", True),  # from package import it
        ("config/config.py", "simmpp.commands.sweep", True),  # in a function
        ("engine/result.py", "simmpp", False),  # for type checkers only
    ],
)
def test_a_digest_covers_what_its_module_imports(
    copy: Path, edited: str, module: str, is_covered: bool
) -> None:
    file = copy / "simmpp" / edited
    before, text = digest_in(copy, module), file.read_text(encoding="utf-8")
    file.write_text(text + "# edited\n", encoding="utf-8")
    assert (digest_in(copy, module) != before) == is_covered
    file.write_text(text, encoding="utf-8")  # for the next one


@pytest.mark.parametrize("module", ["simmpp.no_such_module", "simmpp.workload.nothing"])
def test_a_module_without_a_file_has_no_digest(module: str) -> None:
    with pytest.raises(ModuleNotFoundError, match=module):
        source_digest(module)


@pytest.mark.parametrize("module", modules.NAMED_MODULES)
def test_modules_named_by_a_string_are_there(module: str) -> None:
    assert importlib.util.find_spec(module)
    assert len(source_digest(module)) == 16


def test_no_other_file_names_a_module_by_a_string() -> None:
    """But for the table of the API, which has tests of its own (tests/unit/test_api.py)."""
    named = re.compile(r"""["'](simmpp\.(?!yaml)[a-z_.]+)[:"']""")
    tables = {PACKAGE / name for name in ("__init__.py", "common/modules.py")}
    for file in set(PACKAGE.rglob("*.py")) - tables:
        assert not named.findall(file.read_text(encoding="utf-8")), file


def test_other_packages_keep_their_own_folder() -> None:
    before = numba.config.CACHE_DIR
    compiled.njit(lambda x: x)
    assert before == numba.config.CACHE_DIR
