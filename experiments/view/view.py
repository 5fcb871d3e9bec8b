"""Two scenes as we see them and as Mitsuba 3 does: writes everything else in this folder.

    python experiments/view/view.py [SAMPLES of each pixel in Mitsuba's pictures, default 256]

The scenes, and what is compared, are those of tests/verify/test_view.py (install '.[test]').
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from simmpp.common.files import write_csv
from simmpp.config.config import config_from_mapping, load_config
from simmpp.workload.trace.shading import render, save_png
from simmpp.workload.trace.tracer import trace

sys.path.append(str(Path(__file__).parents[2] / "tests"))

from oracles.mitsuba_room import MitsubaRoom, compare
from rooms import SHAPE, room, yard

HERE = Path(__file__).parent


def main() -> None:
    """Print and write a row per scene and kind of ray, and both pictures beside each other."""
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else 256
    rows = []
    for name, make in (("room", room), ("yard", yard)):
        there = make(HERE)
        glb = {"scene": str(HERE / "room.glb"), "picture": {"resolution": list(SHAPE)}}
        config = config_from_mapping(glb) if name == "room" else load_config(HERE / "yard.yaml")
        assert config.ray_source.scene is not None
        scene, theirs = config.ray_source.scene(), MitsubaRoom(there)
        for kind, found in compare(scene, theirs).items():
            rows.append({"scene": name, "kind": kind, "rays": found.rays, "same": found.same})
            print(rows[-1], flush=True)
        ours = render(scene, config.picture, trace(scene, config.picture))
        save_png(np.hstack([ours, theirs.render(samples)]), HERE / f"{name}.png")
    write_csv(rows, list(rows[0]), HERE / "view.csv")


if __name__ == "__main__":
    main()
