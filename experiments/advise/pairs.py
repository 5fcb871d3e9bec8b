"""Scenes, machines and memories on which advice is developed, and others on which it is judged."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import simmpp
from simmpp.config.config import Config, config_from_mapping
from simmpp.run.inputs import workload_of

SIZES = (4, 16, 64)
LEVELS = (0.15, 0.3, 0.6, 1.5)
"""Memory of a node / bytes of the scene."""
RAYS_BYTES = 8_000
"""Of a node besides, for rays and messages: pictures are small, and so are queues."""

Spec = dict[str, Any]


@dataclass(frozen=True)
class Pair:
    """A scene and a machine with some memory in each node."""

    scene: str
    machine: str
    level: float

    @property
    def name(self) -> str:
        """How rows call it."""
        return f"{self.scene}/{self.machine}/{self.level:g}"


def _bunny(**objects: Any) -> Spec:
    """A scanned mesh, which comes with the tests' pymeshfix."""
    found = find_spec("pymeshfix")
    folder = Path(found.origin or "").parent if found else Path()
    return {"mesh": str(folder / "examples" / "StanfordBunny.ply"), "objects": objects}


DEVELOPED: dict[str, Spec] = {
    "mountain": {"scene": {"spd": "mountain", "size": 4}, "picture": {"resolution": 64}},
    "tetra": {"scene": {"spd": "tetra", "size": 4}, "picture": {"resolution": 64}},
    "balls": {"scene": {"spd": "balls", "size": 3}, "picture": {"resolution": 48}},
    "rings": {"scene": {"spd": "rings", "size": 2}, "picture": {"resolution": 48}},
}
_PATHS = {"resolution": 24, "render": "path", "samples": 2}
JUDGED: dict[str, Spec] = {
    "gears": {"scene": {"spd": "gears", "size": 2}, "picture": {"resolution": 20}},
    "tree": {"scene": {"spd": "tree", "size": 7}, "picture": {"resolution": 48}},
    "jacks": {"scene": {"spd": "jacks", "size": 3}, "picture": {"resolution": 56}},
    "lattice": {"scene": {"spd": "lattice", "size": 5}, "picture": {"resolution": 40}},
    "bunny": {"scene": _bunny(clusters=200), "picture": {"resolution": 64}},
    "bunny-fine": {"scene": _bunny(clusters=60), "picture": {"resolution": 48}},
    "jacks-paths": {"scene": {"spd": "jacks", "size": 3}, "picture": _PATHS},
    "bunny-paths": {"scene": _bunny(clusters=120), "picture": _PATHS},
    "imported": {},
}
"""The last one comes through a table of rays, as from another renderer."""
MACHINES: dict[str, Spec] = {
    "t3e": {"preset": "t3e"},
    "gpu-cluster": {"preset": "gpu-cluster"},
    "t3d": {"preset": "t3d"},
    "xe6-hopper": {"preset": "xe6-hopper", "noise": 0.2},
    "bluegene-l": {"preset": "bluegene-l"},
    "tpu-v4": {"preset": "tpu-v4"},
    "cloud": {"preset": "cloud", "noise": 0.2},
    "cpu-cluster": {"preset": "cpu-cluster"},
    "cluster": {
        "preset": "cpu-cluster",
        "levels": {
            "node": {"size": 4, "latency": "0.5 us", "bandwidth": "100 GB/s"},
            "system": {"latency": "1.5 us", "bandwidth": "100 Gb/s"},
        },
    },
    "t3e-shmem": {"preset": "t3e-shmem"},
}
"""Two with noise: there every candidate's seeds differ."""
_DEVELOPED_ON = ("t3e", "gpu-cluster")


def developed() -> list[Pair]:
    """Those that advice was made with: 4 scenes, 2 machines, 2 memories."""
    return [Pair(s, m, level) for s in DEVELOPED for m in _DEVELOPED_ON for level in LEVELS[1:3]]


def judged() -> list[Pair]:
    """Those that nobody looked at before: 9 other scenes, 8 other machines, each with a memory."""
    machines = [name for name in MACHINES if name not in _DEVELOPED_ON]
    return [
        Pair(scene, machine, LEVELS[(i + j) % len(LEVELS)])
        for i, scene in enumerate(JUDGED)
        for j, machine in enumerate(machines)
    ]


def config_of(pair: Pair, folder: Path) -> Config:
    """The question of a pair; a table of rays is written into the folder."""
    known = DEVELOPED | JUDGED
    spec = known[pair.scene] or {"scene": str(_exported(folder))}
    base = {**spec, "machine": MACHINES[pair.machine]}
    scene_bytes = int(workload_of(config_from_mapping(base)).object_bytes.sum())
    capacity = f"{int(pair.level * scene_bytes) + RAYS_BYTES} B"
    asked = {"processors": list(SIZES)}
    return config_from_mapping({**base, "memory": {"capacity": capacity}, "advise": asked})


def _exported(folder: Path) -> Path:
    """Rays of a scene that is traced with another picture than all others."""
    path = folder / "imported.npz"
    if not path.exists():
        scene = simmpp.load_scene("tetra:5")
        picture = simmpp.Picture(resolution=(64, 48), max_depth=3)
        simmpp.export_workload(simmpp.trace(scene, picture), str(path))
    return path
