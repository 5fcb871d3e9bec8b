"""Equal points are simulated once, and only equal ones."""

from __future__ import annotations

from simmpp.sweeps.sweep import run_sweep

SETTINGS = {
    "scene": "tetra:2",
    "picture": {"resolution": 8},
    "processors": 4,
    "sweep": {"memory.fraction": [0.5, 0.1, 1], "policy": ["object", "replicated"]},
}


def test_the_replicated_scene_lends_its_memory_to_no_other_point() -> None:
    # 0.1 is the default fraction, which once stood for "everything" in the keys of placements
    rows = run_sweep(SETTINGS).rows
    of_object = rows[rows["policy"] == "object"].set_index("fraction")["effective_fraction"]
    assert of_object[0.1] < of_object[0.5] < of_object[1.0] == 1
    assert set(rows[rows["policy"] == "replicated"]["makespan_ps"]) == {
        *rows[(rows["policy"] == "object") & (rows["fraction"] == 1)]["makespan_ps"]
    }
