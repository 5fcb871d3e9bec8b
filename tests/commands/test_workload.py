"""Workloads of one's own from end to end: exported, listed, run, swept, and what can't be done."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from calls import begin_in, refused, simmpp

REST = """
processors: 4
memory: {fraction: 0.3}
policy: [ray, concurrent]
engine: compiled
"""
SCENE = "scene: tetra:2\npicture: {resolution: 12}\n" + REST
OWN = "scene: {workload: rays.parquet}\n" + REST


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("d").mkdir()
    Path("d/scene.yaml").write_text(SCENE)
    Path("d/own.yaml").write_text(OWN)
    done = simmpp("workload", "d/scene.yaml", "--export", "d/rays.parquet")
    assert done.exit_code == 0, done.output


def rows(path: str) -> list[dict[str, str]]:
    """The rows, whatever the scene is called."""
    with open(path, newline="") as file:
        return [row | {"scene": ""} for row in csv.DictReader(file)]


def test_listing() -> None:
    done = simmpp("workload", "d/rays.parquet")
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert lines[0].startswith("rays: 12 x 12 primary rays, ")
    assert lines[1].startswith("16 objects, 2.048 kB; ")
    assert lines[4].split() == [
        "kind", "rays", "tests", "mean", "itinerary", "longest", "without", "tests",
    ]  # fmt: skip
    traced = simmpp("workload", "tetra:2", "--set", "picture.resolution=12")
    assert traced.stdout.splitlines()[1:] == lines[1:]
    assert simmpp("workload", "d/scene.yaml").stdout == traced.stdout


def test_a_run_of_exported_rays_is_the_scenes() -> None:
    for name in ("scene", "own"):
        done = simmpp("run", f"d/{name}.yaml", "--out", name)
        assert done.exit_code == 0, done.output
    assert rows("own/results.csv") == rows("scene/results.csv")


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_sweep_of_exported_rays_is_the_scenes(workers: str) -> None:
    axes = "sweep={memory.fraction: [0.3, 1], processors: [2, 4]}"
    for name in ("scene", "own"):
        arguments = ("--workers", workers, "--set", axes, "--out", name)
        done = simmpp("sweep", f"d/{name}.yaml", *arguments)
        assert done.exit_code == 0, done.output
    assert rows("own/results.csv") == rows("scene/results.csv")
    assert rows("own/profits.csv") == rows("scene/profits.csv")


def test_files_are_looked_for_beside_the_configuration_or_here() -> None:
    assert simmpp("run", "d/own.yaml").exit_code == 0
    line = refused("run", "d/own.yaml", "--set", "scene=rays.parquet")
    assert line == "rays.parquet: there is no such file"
    assert simmpp("run", "d/own.yaml", "--set", "scene=d/rays.parquet").exit_code == 0


def test_what_needs_geometry() -> None:
    expected = "expected a scene to trace; a workload file has rays, but no geometry"
    assert refused("run", "d/own.yaml", "--verify") == f"--verify: {expected}"
    assert refused("run", "d/own.yaml", "--picture", "p.png") == f"--picture: {expected}"
    assert refused("run", "d/own.yaml", "--set", "picture.resolution=8").endswith(
        "picture goes with a scene that is traced, not with scene.workload"
    )


def test_messages_that_outlast_the_clock_are_refused() -> None:
    """A TiB at 1 kB/s takes 35 years; its picoseconds would wrap."""
    np.savez(
        "d/big.npz",
        itinerary_offsets=[0, 2, 4],
        itinerary_objects=[0, 1, 1, 0],
        object_bytes=[2**40, 2**40],
    )
    slow = ("--set", "scene=d/big.npz", "--set", "machine.link_bandwidth=1 kB/s")
    few = ("--set", "processors=2", "--set", "memory.fraction=0")
    assert "the simulated time exceeds the clock" in refused("run", "d/own.yaml", *slow, *few)
    assert simmpp("run", "d/own.yaml", *slow[:2], *few).exit_code == 0


def test_what_is_no_workload() -> None:
    Path("d/rays.objects.parquet").unlink()
    beside = "expected the table of objects beside it, rays.objects.parquet"
    assert refused("run", "d/own.yaml") == f"d/rays.parquet: {beside}"
    Path("d/own.yaml").write_text("scene: {workload: a.npz, size: 3}\n")
    assert refused("run", "d/own.yaml") == "d/own.yaml:1: scene: size goes with spd only"
    Path("d/own.yaml").write_text("scene: {workload: a.npz, nff: b.nff}\n")
    one = "expected one of spd, nff, mesh, parts, cells, workload, got nff and workload"
    assert refused("run", "d/own.yaml") == f"d/own.yaml:1: scene: {one}"
