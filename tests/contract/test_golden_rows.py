"""Rows of 144 simulations are, byte for byte, what they were before the package was rearranged."""

from pathlib import Path

import pytest

from simmpp.sweeps.sweep import run_sweep

GOLDEN = Path(__file__).parents[1] / "golden" / "rows"


def test_rows_are_those_of_before(tmp_path: Path) -> None:
    run_sweep(GOLDEN / "sweep.yaml", out=tmp_path)
    for name in ("results.csv", "profits.csv"):
        if (tmp_path / name).read_bytes() != (GOLDEN / name).read_bytes():
            pytest.fail(f"{name} has moved: compare {tmp_path / name} with {GOLDEN / name}")
