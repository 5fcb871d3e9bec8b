"""What does not fit into memory is a result: commands take it, and say it where one reads."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from calls import begin_in, simmpp

SOME_FIT = """
scene: tetra:2
picture: {resolution: 6}
reading: plain
policy: [object, ray, replicated]
memory: {fraction: 30%, transient: 0}
seeds: [0, 1]
sweep: {processors: [2, 4, 8], memory.capacity: [1500 B, 2500 B, none]}
"""
REFINED = "--workers 1 --set refine=true --set tolerance=20% --set max_seeds=9"
GB = 10**9
NODES = """
scene: renderer.npz
policy: [object, ray, concurrent, replicated]
machine: {preset: cpu-cluster, service: pe}
memory: {capacity: 32 GB, fraction: 0%}
sweep: {processors: [4, 8, 16, 32, 64]}
"""


def rows_of(path: Path) -> list[dict[str, str]]:
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One whose sweep is done."""
    there = tmp_path_factory.mktemp("fits")
    with pytest.MonkeyPatch.context() as patch:
        begin_in(there, patch)
        Path("c.yaml").write_text(SOME_FIT)
        assert simmpp("sweep", "c.yaml", "--out", "done", "--workers", "1").exit_code == 0
        kinds = {
            (row["fits"], row["makespan_ps"] == "") for row in rows_of(Path("done/results.csv"))
        }
        assert kinds == {("0", True), ("1", False), ("", False)}
    return there


@pytest.mark.parametrize(
    "command",
    [
        "sweep c.yaml --out t --workers 1 --set tolerance=20% --set max_seeds=9",
        f"sweep c.yaml --out r {REFINED}",
        f"sweep c.yaml --out none {REFINED} --set sweep.memory.capacity=[100B,200B]",
        "check c.yaml --baseline b --update --workers 1",
        "bench c.yaml --seeds 4 --workers 1 --out bench --set sweep.processors=[8]",
        "report done",
        "report done other=done --out both.html",
        "compare done done --out compare.html",
    ],
)
def test_every_command_takes_rows_of_what_does_not_fit(
    command: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin_in(folder, monkeypatch)
    done = simmpp(*command.split())
    assert done.exit_code == 0, done.output
    if "--baseline" in command:
        again = simmpp("check", "c.yaml", "--baseline", "b/profits.csv", "--workers", "1")
        assert again.exit_code == 0, again.output
    if "tolerance" in command:  # what does not fit takes no further seeds
        alone = [
            row for row in rows_of(Path("t/results.csv")) if row["memory.capacity"] == "1500 B"
        ]
        assert {row["policy"] for row in alone if row["makespan_ps"] == ""} >= {"replicated"}


def test_which_policies_of_200_gb_fit_on_how_many_nodes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A thousand objects of 200 MB, of which nothing but the sizes is known; nodes of 32 GB."""
    begin_in(tmp_path, monkeypatch)
    places = np.random.default_rng(0).random((3, 1000))
    np.savez(
        "renderer.npz",
        itinerary_offsets=np.arange(0, 129, 2),
        itinerary_objects=np.arange(128) * 7 % 1000,
        object_bytes=np.full(1000, GB // 5),
        **dict(zip(("object_x", "object_y", "object_z"), places, strict=True)),
    )
    Path("c.yaml").write_text(NODES)
    done = simmpp("sweep", "c.yaml", "--out", "o", "--workers", "1")
    assert done.exit_code == 0, done.output
    flows = (
        "Concurrent dataflow, object dataflow and ray dataflow do not fit in 1 of 5 cases (4 PEs)"
    )
    said = (
        "The replicated scene does not fit in all 5 cases (4 to 64 PEs): each PE lacks 168 GB.",
        f"{flows}: each PE lacks 18.2 GB.",  # a quarter of it all, and one object more
    )
    assert simmpp("report", "o").exit_code == 0
    page = Path("o/report.html").read_text()
    for sentence in said:
        assert sentence in done.output
        assert sentence in page
    for row in rows_of(Path("o/results.csv")):
        nb, is_replicated = int(row["processors"]), row["policy"] == "replicated"
        assert row["fits"] == str(int(nb > 4 and not is_replicated)), row
        owned = 200 * GB if is_replicated else 1000 // nb * GB // 5
        assert owned <= int(row["least_bytes"]) < owned + GB
        assert (row["makespan_ps"] == "") == (row["fits"] == "0")
    lines = [line.split() for line in done.output.splitlines()]
    assert ["8", "fits", "fits", "fits"] in lines
