"""Cells of absurd sizes and materials: particles add up, or it is one line.

SIMMPP_TEST_CASES says how many (40 if unset).
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import pytest

from simmpp.common.errors import ConfigError
from simmpp.common.strict import structure
from simmpp.workload.check import check
from simmpp.workload.particles import follow
from simmpp.workload.particles.cells import SIDES, Cells
from simmpp.workload.particles.grid import ONE
from simmpp.workload.particles.settings import Particles
from simmpp.workload.particles.tracer import tallies, trace

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "40"))
SIZES = (1e-30, 1e-9, 1e-3, 1.0, 7.0, 1e3, 1e9, 1e25)
COUNT = 20


def random_cells(rng: np.random.Generator) -> dict[str, Any]:
    size = rng.choice(SIZES, 3)
    odd = {
        "sigma_t": float(rng.choice((0.0, *SIZES))),
        "albedo": float(rng.choice((0, 0.5, 0.99, 1))),
        "g": float(rng.choice((0, 0.9, -0.999999, 0.999999))),
    }
    importances = [int(2**k) for k in rng.integers(0, 4, 2)]
    return {
        "grid": rng.integers(1, 5, 3).tolist(),
        "size": size.tolist(),
        "materials": {"odd": odd, "plain": {"sigma_t": 1, "albedo": 0.3}},
        "boxes": [
            {"material": "odd", "low": [0, 0, 0], "high": size.tolist(),
             "importance": importances[0]},
            {"material": "plain", "low": [0, 0, 0], "high": (size / 2).tolist(),
             "importance": importances[1]},
        ],
        "mirrors": [side for side in SIDES if rng.random() < 0.4],
        "source": {
            "low": (size * rng.choice((0, 0.5, 1), 3)).tolist(),
            "high": size.tolist(),
            "emits": str(rng.choice(("isotropic", "cosine", "beam"))),
            "towards": rng.choice((-1, 0, 1, 1e-20, 1e20), 3).tolist(),
        },
    }  # fmt: skip


def test_particles_add_up_or_it_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(follow, "SEGMENTS", 2**13)
    monkeypatch.setattr(follow, "MOST_SEGMENTS", 2**15)
    followed = 0
    for seed in range(CASES):
        rng = np.random.default_rng((seed, 7))
        keys, capture = random_cells(rng), ("analogue", "implicit")[seed % 2]
        try:
            cells = structure(Cells, keys, {})
            particles = Particles(count=COUNT, capture=capture, splitting=seed % 3 == 0)
            workload, tally = trace(cells, particles, threads=1), tallies(cells, particles)
        except ConfigError as error:
            assert len(str(error).splitlines()) == 1, seed
            continue
        check(workload, f"seed {seed}")
        assert tally.absorbed.sum() == COUNT * ONE, seed
        assert (tally.tracks >= 0).all() and np.isfinite(tally.track_squares).all(), seed
        followed += 1
    assert followed > 0.7 * CASES
