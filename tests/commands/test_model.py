"""``simmpp model``: the grid, the tables and pictures that it writes, and mistakes."""

import csv
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from simmpp.cli import main

CONFIG = """
scene: {spd: tetra, size: 2}
picture: {resolution: 24}
sweep: {processors: [4, 8], memory.fraction: [1/4, 0.5, 1]}
"""


def model(tmp_path: Path, text: str, *options: str) -> Result:
    path = tmp_path / "model.yaml"
    path.write_text(text, encoding="utf-8")
    return CliRunner().invoke(main, ["model", str(path), *options])


def rows(tmp_path: Path) -> list[dict[str, str]]:
    with open(tmp_path / "out" / "figure2.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_writes_rows_and_pictures_of_the_sweep(tmp_path: Path) -> None:
    done = model(tmp_path, CONFIG, "--out", str(tmp_path / "out"), "--ratio", "startup=2")
    assert done.exit_code == 0, done.output
    found = rows(tmp_path)
    places = [(row["processors"], row["fraction"]) for row in found]
    assert places == [(nb, x) for nb in ("4", "8") for x in ("0.25", "0.5", "1.0")]
    for row in found:
        ratio = int(row["ray_ps"]) / int(row["object_ps"])
        assert float(row["ray_over_object"]) == pytest.approx(ratio, rel=1e-6)
        assert row["winner"] == ("object" if ratio > 1 else "ray" if ratio < 1 else "tie")
    assert (tmp_path / "out" / "figure2.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (tmp_path / "out" / "figure2.svg").read_text(encoding="utf-8")
    assert "claim F2a" in done.output and "claim F2b" in done.output


def test_measured_r_is_another_method(tmp_path: Path) -> None:
    out = ("--out", str(tmp_path / "out"), "--ratio", "test=1")
    model(tmp_path, CONFIG, *out)
    assumed = rows(tmp_path)
    done = model(tmp_path, CONFIG, *out, "--set", "method=analytical-measured")
    assert done.exit_code == 0, done.output
    measured = rows(tmp_path)
    assert {row["method"] for row in measured} == {"analytical-measured"}
    assert [row["object_ps"] for row in measured] != [row["object_ps"] for row in assumed]


def test_without_axes_the_grid_is_that_of_the_claims(tmp_path: Path) -> None:
    done = model(tmp_path, CONFIG.split("sweep")[0], "--out", str(tmp_path / "out"))
    assert done.exit_code == 0, done.output
    assert len(rows(tmp_path)) == 8 * 14


def test_one_point_and_costs_of_nothing_have_a_figure(tmp_path: Path) -> None:
    free = "machine: {send_startup: 0, receive_startup: 0, pack: {bandwidth: unlimited},"
    free += " unpack: {bandwidth: unlimited}}"
    text = CONFIG.split("sweep")[0] + free + "\nsweep: {processors: [4], memory.fraction: [0.5]}"
    done = model(tmp_path, text, "--out", str(tmp_path / "out"))
    assert done.exit_code == 0, done.output
    assert [row["winner"] for row in rows(tmp_path)] == ["tie"]


def test_other_axes_are_said_to_be_left_out(tmp_path: Path) -> None:
    done = model(tmp_path, CONFIG.replace("sweep: {", "sweep: {scene: [tetra:1, tetra:2], "))
    assert done.exit_code == 0
    assert "the model takes scene as set outside of the sweep" in done.output


@pytest.mark.parametrize("ratio", ["startup", "startup=", "startup=-1", "startup=nan", "hop=2"])
def test_a_wrong_ratio_is_one_line(tmp_path: Path, ratio: str) -> None:
    done = model(tmp_path, CONFIG, "--ratio", ratio)
    assert done.exit_code == 2
    assert f"--ratio: value '{ratio}'" in done.output and "startup, packing" in done.output


def test_memories_in_bytes_are_refused(tmp_path: Path) -> None:
    done = model(tmp_path, CONFIG.replace("memory.fraction: [1/4", "memory.bytes: [1 kB]}\n#"))
    assert done.exit_code == 2
    assert "expected shares, memory.fraction, for the model" in done.output
