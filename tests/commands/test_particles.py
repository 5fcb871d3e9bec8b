"""Particles as a user meets them: run, drawn, verified, exported."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from calls import begin_in, refused, simmpp
from PIL import Image

CONFIG = """
scene: shield
particles: {count: 300, splitting: true}
processors: 4
memory: {fraction: 30%}
placement: {pixels: home}
policy: [{name: object, label: cell passing}, ray]
"""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("c.yaml").write_text(CONFIG)


def test_run_says_it_in_their_words_draws_and_verifies() -> None:
    done = simmpp("run", "c.yaml", "--picture", "p.png", "--until", "1 min", "--verify")
    assert done.exit_code == 0, done.output
    assert "shield: 300 particles, " in done.stdout
    assert "in the words of particle transport: object dataflow is cell (or mesh) passing" in (
        " ".join(done.stdout.split())
    )
    assert "verify cell passing: the result of its tests is the same" in done.stdout
    assert "cell passing at 60 s: 100.0% of 300 particles are finished" in done.stdout
    with Image.open("p.png") as whole, Image.open("p-ray.png") as of_ray:
        assert (np.array(whole) == np.array(of_ray)).all()
        # Mirrors double both sides, and the source is the brightest.
        assert whole.size == (960, 960)
        assert whole.getpixel((480, 480)) == (252, 255, 164)
        assert whole.getpixel((100, 200)) == whole.getpixel((859, 759))


def test_as_tables_they_are_the_same() -> None:
    done = simmpp("workload", "c.yaml", "--export", "w.parquet")
    assert done.exit_code == 0, done.output
    assert "300 particles" in done.stdout
    own, other = (
        simmpp("run", *what, "--policy", "ray", "--out", out, "--seed", "0")
        for what, out in (
            (("c.yaml",), "own"),
            (("c.yaml", "--set", "scene=w.parquet", "--set", "particles=null"), "other"),
        )
    )
    assert own.exit_code == other.exit_code == 0, other.output
    rows = [pd.read_csv(Path(out, "results.csv")) for out in ("own", "other")]
    measured = ["policy", "rays", "tests", "makespan_ps", "messages", "bytes_sent"]
    assert rows[0][measured].equals(rows[1][measured])


def test_what_has_no_surfaces() -> None:
    line = refused("scene", "hohlraum")
    assert line.endswith("particles fly through cells, which have no surfaces")
