"""What rays leave in objects, as a user gets it: of a path traced picture, of a table of rays."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from calls import begin_in, simmpp
from pyarrow import parquet

PATHS = """
scene: mountain:3
picture: {render: path, resolution: 8, samples: 2}
processors: 4
placement: {tallies: send, rounds: {window: 2}}
policy: [object, ray]
"""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)


def test_hits_of_a_picture_are_told_and_verified() -> None:
    Path("p.yaml").write_text(PATHS)
    done = simmpp("run", "p.yaml", "--results", "r.csv", "--verify")
    assert done.exit_code == 0, done.output
    told = pd.read_csv("r.csv")
    assert list(told.columns) == ["object", "sum", "sum_of_squares", "count"]
    assert told["count"].sum() > 64
    assert (told["sum"] == told["count"]).all()  # a hit weighs 1
    lines = done.stdout.splitlines()
    same = "the picture of its tests is the same, and so is what they leave in 132 objects"
    assert [line for line in lines if line.endswith(same)] == [
        f"verify {policy}: {same}" for policy in ("object", "ray", "replicated")
    ]
    assert "all rays are of one round: placement.rounds decides nothing" in lines
    assert "no object has results: tallies send sends nothing" in lines


def test_rounds_and_tallies_of_a_table_are_told() -> None:
    n = 60
    objects = np.arange(n) % 5
    rays = {"itinerary": [[o] for o in objects], "round": np.arange(n) // 20, "hit": objects}
    rays |= {"home": objects, "deposit": [[0.5]] * n}
    parquet.write_table(pa.table(rays), "a.parquet")
    sizes = {"bytes": [100] * 5, "results": [8] * 5}
    parquet.write_table(pa.table(sizes), "a.objects.parquet")
    Path("a.yaml").write_text("scene: a.parquet\nprocessors: 4\npolicy: object\n")
    done = simmpp("run", "a.yaml", "--results", "r.parquet", "--out", "out")
    assert done.exit_code == 0, done.output
    told = pd.read_parquet("r.parquet")
    assert told["sum"].tolist() == [6.0] * 5
    assert told["sum_of_squares"].tolist() == [3.0] * 5
    assert told["count"].tolist() == [12] * 5
    assert "3 rounds of rays: 2 barriers of" in done.stdout
    assert "results of 40 B, reduce: a copy on every PE" in done.stdout
    (row,) = pd.read_csv("out/results.csv").query("policy == 'object'").to_dict("records")
    assert row["barriers"] == 2
    assert row["round_messages"] == 2 * 2 * 4
    assert row["tally_messages"] == 2 * 4
    assert row["reduction_ps"] > 0
    spread = simmpp("run", "a.yaml", "--set", "placement.tallies=send", "--out", "sent")
    assert "results of 40 B, send: deposits, and messages with them: object " in spread.stdout
