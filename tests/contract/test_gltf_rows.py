"""A glTF of several primitives: the same objects and rows in every process, however it is run."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from gltf_files import File

from simmpp.common.cache import cache_folder
from simmpp.sweeps.journal import FILE

PROCESSES = int(os.environ.get("SIMMPP_TEST_CASES", "2"))
TABLES = ("results.csv", "results.parquet", "profits.csv")
CONFIG = """\
scene: {mesh: grids.gltf}
picture: {resolution: 32}
processors: 4
memory: {fraction: 0.25}
policy: [object, ray, concurrent]
"""


def grid(file: File, n: int, offset: float) -> dict[str, object]:
    """A primitive: a square of n by n cells, each primitive with other triangles."""
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    corners = np.stack([x.ravel() + offset, y.ravel(), 0 * x.ravel() + offset / 9], axis=1)
    cell = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()[:, None]
    halves = cell + np.array([0, 1, n + 2, 0, n + 2, n + 1])
    indices = file.accessor(halves.ravel(), "u2")
    return {"attributes": {"POSITION": file.accessor(corners)}, "indices": indices}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where the file and its configuration are; compiled code stays where it is."""
    folder = tmp_path_factory.mktemp("gltf")
    (folder / "c.yaml").write_text(CONFIG)
    file = File()
    mesh = file.mesh(*(grid(file, n, 1.5 * n) for n in range(2, 8)))
    for name, height in (("b", 0.0), ("a", 1.5)):
        file.node(mesh=mesh, name=name, translation=[0, height, 0])
    file.write(folder / "grids.gltf")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("NUMBA_CACHE_DIR", str(cache_folder() / "compiled"))
        patch.chdir(folder)
        yield folder


def call(*arguments: str, cache: str = "cache") -> str:
    """The command in a process of its own, with a hash seed of its own."""
    environment = os.environ | {"PYTHONHASHSEED": "random", "SIMMPP_CACHE": cache}
    program = [sys.executable, "-c", "from simmpp.cli import main; main()"]
    return subprocess.check_output([*program, *arguments], env=environment, text=True)


def tables(out: str) -> list[bytes]:
    return [Path(out, name).read_bytes() for name in TABLES]


@pytest.fixture(scope="module")
def swept(folder: Path) -> list[bytes]:
    """The tables of a sweep in one process."""
    call("sweep", "c.yaml", "--workers", "1", "--out", "one")
    return tables("one")


def test_every_process_lists_the_same_objects(folder: Path) -> None:
    (listed,) = {call("scene", "grids.gltf:nodes") for _ in range(PROCESSES)}
    names = [line.split()[2] for line in listed.splitlines() if " mesh " in line]
    assert names == [f"{node}.{primitive}" for node in "ba" for primitive in range(6)]


def test_every_process_gives_the_same_rows(swept: list[bytes]) -> None:
    """Each traces for itself: nothing is taken from a cache."""
    for n in range(PROCESSES):
        call("sweep", "c.yaml", "--workers", "1", "--out", str(n), cache=f"cache{n}")
        assert tables(str(n)) == swept


def test_two_workers_give_the_same_rows(swept: list[bytes]) -> None:
    call("sweep", "c.yaml", "--workers", "2", "--out", "two", cache="another")
    assert tables("two") == swept


def test_a_sweep_resumes(swept: list[bytes]) -> None:
    shutil.copytree("one", "stopped")
    journal = Path("stopped", FILE)
    first, *_ = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(first)
    for name in TABLES:
        Path("stopped", name).unlink()
    call("sweep", "c.yaml", "--workers", "1", "--out", "stopped", cache="resumed")
    assert tables("stopped") == swept
    assert len(journal.read_bytes().splitlines()) > 1


def test_a_baseline_holds(folder: Path) -> None:
    baseline = ("check", "c.yaml", "--workers", "1", "--baseline", "kept/profits.csv")
    Path("kept").mkdir()
    call(*baseline, "--update")
    call(*baseline, cache="checked")  # an exit code other than 0 is an error
