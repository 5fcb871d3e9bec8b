"""Cells whose particles are known in closed form: slabs, and a point source in all of space."""

from __future__ import annotations

from typing import Any

from simmpp.workload.particles.cells import Cells, long_cells

ASIDE = ("-x", "+x", "-y", "+y")
SIDE = 1000.0
"""Of slabs, so that few particles come to the mirrors aside."""


def slab(depth: float, *, cells: int = 4, emits: str = "beam", **material: float) -> Cells:
    """A slab with sigma_t = 1, lit from z = 0."""
    size = (SIDE, SIDE, depth)
    return Cells(
        grid=(1, 1, cells),
        size=size,
        materials={"slab": {"sigma_t": 1.0, **material}},
        boxes=[{"material": "slab", "low": (0, 0, 0), "high": size}],
        mirrors=ASIDE,
        source={"low": (0, 0, 0), "high": (SIDE, SIDE, 0), "emits": emits, "towards": (0, 0, 1)},
    )


def point(n: int, albedo: float) -> Cells:
    """A point source in the middle of n x n x n cells of one mean free path."""
    return Cells(
        grid=(n, n, n),
        size=(n, n, n),
        materials={"all": {"sigma_t": 1.0, "albedo": albedo}},
        boxes=[{"material": "all", "low": (0, 0, 0), "high": (n, n, n)}],
        source={"low": (n / 2, n / 2, n / 2)},
    )


def preset(name: str, **keys: Any) -> Cells:
    return Cells.model_validate(long_cells({"preset": name, **keys}))
