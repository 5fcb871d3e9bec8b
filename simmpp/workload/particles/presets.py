"""Cells of the field's own test problems, as one would write them below ``scene.cells``."""

from __future__ import annotations

from typing import Any

# van de Hulst 1980, "Multiple light scattering", table 35: a slab of optical depth 2, lit from
# above; MCML checks itself against it (Wang, Jacques and Zheng 1995, table 1).
SLAB = {
    "grid": [8, 8, 16],
    "size": [1, 1, 1],
    "materials": {"slab": {"sigma_t": 2, "albedo": 0.9, "g": 0.75}},
    "boxes": [{"material": "slab", "low": [0, 0, 0], "high": [1, 1, 1]}],
    "mirrors": ["-x", "+x", "-y", "+y"],
    "source": {"low": [0, 0, 0], "high": [1, 1, 0], "emits": "beam", "towards": [0, 0, 1]},
}

# Branson (LANL), inputs/big_cube.xml: 2 cm, 100 / cm, mirrors all round; its 200 cells along each
# side are fineness 10. ESTIMATE: albedo, which stands for absorption and emission within a step.
CUBE = {
    "grid": [20, 20, 20],
    "size": [2, 2, 2],
    "materials": {"matter": {"sigma_t": 100, "albedo": 0.9}},
    "boxes": [{"material": "matter", "low": [0, 0, 0], "high": [2, 2, 2]}],
    "mirrors": ["-x", "+x", "-y", "+y", "-z", "+z"],
    "source": {"low": [0, 0, 0], "high": [2, 2, 2]},
}

# Branson (LANL), inputs/3D_hohlraum_single_node.xml, all lengths and opacities; its cells of 0.01
# cm are fineness 5. Hot gas stands before a thick wall with a ring-shaped hole; behind it are two
# gaps with a capsule between. ESTIMATE: albedo of the wall, which stands for its emission.
HOHLRAUM = {
    "grid": [13, 13, 28],
    "size": [0.65, 0.65, 1.4],
    "materials": {
        "gas": {"sigma_t": 0.001},
        "wall": {"sigma_t": 10000, "albedo": 0.9},
    },
    "boxes": [
        {"material": "gas", "low": [0, 0, 0], "high": [0.65, 0.65, 0.1]},
        {"material": "wall", "low": [0, 0, 0.1], "high": [0.65, 0.65, 1.4]},
        {"material": "gas", "low": [0, 0, 0.1], "high": [0.6, 0.6, 1.35]},
        {"material": "wall", "low": [0, 0, 0.1], "high": [0.4, 0.4, 0.15]},
        {"material": "wall", "low": [0, 0, 0.55], "high": [0.4, 0.4, 0.95]},
    ],
    "mirrors": ["-x", "-y"],
    "source": {"low": [0, 0, 0], "high": [0.65, 0.65, 0.1]},
}

# Kobayashi, Sugimura and Nagaya 2001, "3D radiation transport benchmark problems and results for
# simple geometries with void region", problem 1 with half of all collisions scattering: a source
# in a corner of a void cube within a shield. ESTIMATE: importances.
SHIELD = {
    "grid": [10, 10, 10],
    "size": [100, 100, 100],
    "materials": {
        "void": {"sigma_t": 0.0001, "albedo": 0.5},
        "shield": {"sigma_t": 0.1, "albedo": 0.5},
    },
    "boxes": [
        *(
            {"material": "shield", "low": [0, 0, 0], "high": [side] * 3, "importance": importance}
            for side, importance in ((100, 32), (90, 16), (80, 8), (70, 4), (60, 2))
        ),
        {"material": "void", "low": [0, 0, 0], "high": [50, 50, 50]},
        {"material": "shield", "low": [0, 0, 0], "high": [10, 10, 10]},
    ],
    "mirrors": ["-x", "-y", "-z"],
    "source": {"low": [0, 0, 0], "high": [10, 10, 10]},
}

PRESETS: dict[str, dict[str, Any]] = {
    "slab": SLAB,
    "cube": CUBE,
    "hohlraum": HOHLRAUM,
    "shield": SHIELD,
}
