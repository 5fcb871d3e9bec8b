"""Radiosity as a user meets it: run, sweep, report and check, pictures, tables, refusals."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from calls import begin_in, refused, simmpp
from PIL import Image

from simmpp.common.files import read_csv

BOX = Path(__file__).parents[2] / "experiments" / "path" / "cornell.obj"
CONFIG = f"""
scene: {{mesh: {BOX}, objects: groups, lights: []}}
reading: plain
radiosity: {{patches: 3%, rays: 32, resolution: 12}}
processors: 4
placement: {{pixels: home}}
memory: {{fraction: 30%}}
policy: [object, ray, concurrent]
"""
SHOOTING = ("--set", "radiosity.method=shooting", "--set", "radiosity.residual=5%")


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("c.yaml").write_text(CONFIG)


@pytest.mark.parametrize("over", [(), SHOOTING], ids=["gathering", "shooting"])
def test_run_draws_tells_and_verifies(over: tuple[str, ...]) -> None:
    files = ("--picture", "p.png", "--results", "r.csv", "--out", "out", "--until", "1 min")
    done = simmpp("run", "c.yaml", *over, *files, "--verify")
    assert done.exit_code == 0, done.output
    assert "rays of patches" in done.stdout.splitlines()[0]
    verdicts = [line for line in done.stdout.splitlines() if line.startswith("verify ")]
    assert len(verdicts) == 4
    assert all(": the result of its tests is the same, and so is" in line for line in verdicts)
    with Image.open("p.png") as whole, Image.open("p-ray.png") as finished:
        assert whole.size == (12, 12)
        assert (np.array(whole) == np.array(finished)).all()
        assert np.array(whole).max() > 100
    patches = read_csv(Path("r.csv"), ["object", "red", "back_red", "hits"])
    assert f"{len(patches)} objects" in done.stdout
    with Path("out/results.csv").open() as file:
        (row, *_) = csv.DictReader(file)
    assert ("residual_tenth_ps" in row) == bool(over)
    assert ("until 10 % is left" in done.stdout) == bool(over)
    if over:
        assert 0 < int(row["residual_tenth_ps"]) < int(row["makespan_ps"])
        assert row["residual_hundredth_ps"] == ""


def test_sweep_report_and_check_take_it() -> None:
    with Path("c.yaml").open("a") as file:
        file.write("sweep: {memory.fraction: [0.3, 0.6], radiosity.seed: [0, 1]}\n")
    assert simmpp("sweep", "c.yaml", "--workers", "1", "--out", "s").exit_code == 0
    assert simmpp("report", "s").exit_code == 0
    done = simmpp("check", "c.yaml", "--baseline", "s/profits.csv")
    assert done.exit_code == 0, done.output
    profits = read_csv(Path("s/profits.csv"), ["policy", "radiosity.seed", "time_profit"])
    of_ray = {row["time_profit"] for row in profits if row["policy"] == "ray"}
    assert len(of_ray) == 4  # other rays, other profits


REFUSED = {
    "--set radiosity: value 0: expected a share above 0%": (
        "--set", "radiosity={method: shooting, residual: 0}"
    ),
    "c.yaml:4: radiosity: residual goes with method: shooting": (
        "--set", "radiosity.residual=2%"
    ),
    "object 1 is curved: expected polygons and meshes": ("--set", "scene=balls:1"),
    "nothing shines: expected a material with Ke (OBJ)": ("--set", "scene=tetra:2"),
    "expected one of picture, radiosity": ("--set", "picture.resolution=8"),
    "--results: value 'r.txt': expected a file .csv or .parquet": ("--results", "r.txt"),
}  # fmt: skip


@pytest.mark.parametrize("problem", REFUSED)
def test_nonsense_is_one_line(problem: str) -> None:
    assert problem in refused("run", "c.yaml", *REFUSED[problem])


def test_tables_go_out_and_come_back() -> None:
    done = simmpp("workload", "c.yaml", *SHOOTING, "--export", "w.parquet")
    assert done.exit_code == 0, done.output
    Path("w.yaml").write_text(
        "scene: w.parquet\nreading: plain\nprocessors: 4\npolicy: [object, ray, concurrent]\n"
    )
    rows = []
    for config, over in (("c.yaml", SHOOTING), ("w.yaml", ())):
        same = ("--set", "placement.pixels=home", "--set", "memory.fraction=30%")
        done = simmpp("run", config, *over, *same, "--out", f"out-{config}")
        assert done.exit_code == 0, done.output
        with Path(f"out-{config}/results.csv").open() as file:
            rows.append({row["policy"]: row["makespan_ps"] for row in csv.DictReader(file)})
    assert all(rows[0][policy] == rows[1][policy] for policy in rows[1])
