"""Policies on path-traced pictures and on Whitted's rays of the same scenes.

    python experiments/path/path.py

Writes path.csv (a row per scene, way to render, x, what is kept and policy: means over seeds),
unless it is there, expected.csv (each expectation of README.md and what came out), and the figure.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

import simmpp
from simmpp.common.files import write_csv
from simmpp.placement.placement import Placement
from simmpp.plot.matplotlib_panels import SETTINGS, save
from simmpp.scene.scene import Camera, Light, Polygon, Scene
from simmpp.workload.cache.store import workload_for
from simmpp.workload.workload import Workload

sys.path.append(str(Path(__file__).parent))

from cornell import box

HERE = Path(__file__).parent
FRACTIONS = (Fraction(2, 100), Fraction(1, 10), Fraction(1, 4), Fraction(1, 2))
POLICIES = ("object", "ray", "concurrent")
PROCESSORS, RESOLUTION, SAMPLES, DEPTH, SEEDS = 64, 64, 4, 8, (0, 1, 2)
WALL, BLOCK = 14, 7
"""Squares along each side of a wall, and of a block's face."""
COLOURS = {"object": "#d55e00", "ray": "#0072b2", "concurrent": "#009e73"}
Row = dict[str, Any]


def room() -> Scene:
    """The Cornell box with a front wall, seen from inside, its surfaces cut into squares."""
    scene, squares = box(), []
    for part in scene.objects:
        for face in part.vertices[part.faces].reshape(-1, 2, 3, 3):  # type: ignore[union-attr]
            (a, b, c), d = face[0], face[1, 2]
            is_wall = np.ptp(face.reshape(-1, 3), axis=0).max() > 350
            n = 1 if part.name.startswith("lamp") else WALL if is_wall else BLOCK  # type: ignore[union-attr]
            squares += [Polygon(corners, None, part.material) for corners in _cut(a, b, c, d, n)]
    front = np.array([(556, 0, 0), (0, 0, 0), (0, 548.8, 0), (556, 548.8, 0)], np.float64)
    squares += [
        Polygon(corners, None, scene.objects[0].material)
        for corners in _cut(front[0], front[1], front[2], front[3], WALL)
    ]
    camera = Camera((278, 273, 5), (278, 240, 500), (0, 1, 0), 75)
    return replace(scene, name="room", objects=tuple(squares), camera=camera)


def _cut(a: Any, b: Any, c: Any, d: Any, n: int) -> Iterator[Any]:
    """n x n quadrilaterals of one."""
    at = np.linspace(0, 1, n + 1)
    u, v = at[:, None, None], at[None, :, None]
    grid = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    for i in range(n):
        for j in range(n):
            yield np.array([grid[i, j], grid[i + 1, j], grid[i + 1, j + 1], grid[i, j + 1]])


def scenes() -> dict[tuple[str, str], Scene]:
    """By scene and way to render; Whitted's rays know no lamp, so a point stands in its place."""
    mountain, closed = simmpp.load_scene("mountain:5"), room()
    point = replace(closed, lights=(Light((278, 540, 280)),))
    return {
        ("mountain:5", "whitted"): mountain,
        ("mountain:5", "path"): mountain,
        ("room", "whitted"): point,
        ("room", "path"): closed,
    }


def uses(workload: Workload, placement: Placement) -> int:
    """Tests of objects that are not resident where the pixel starts: all by fetched ones."""
    holds = np.zeros((placement.processors, workload.n_objects), bool)
    holds[placement.owners, np.arange(workload.n_objects)] = True
    pes = np.repeat(np.arange(placement.processors), np.diff(placement.replica_offsets))
    holds[pes, placement.replica_objects] = True
    rays = np.repeat(np.arange(workload.n_rays), np.diff(workload.itinerary_offsets))
    at = placement.pixel_pes[workload.pixels[rays]]
    return int((~holds[at, workload.itinerary_objects]).sum())


def rows_of(scene: Scene, name: str, render: str) -> list[Row]:
    """Means over the seeds."""
    picture = simmpp.Picture(resolution=RESOLUTION, samples=SAMPLES)
    if render == "path":
        picture = replace(picture, render="path", depth=DEPTH)
    workload = workload_for(scene, picture)
    machine, rules = simmpp.make_machine("t3e", processors=PROCESSORS), simmpp.PlacementRules()
    rows = []
    for fraction in FRACTIONS:
        for kept in (Fraction(0), fraction):
            memory = simmpp.Memory(fraction=fraction, transient=kept)
            found: dict[str, list[dict[str, float]]] = {policy: [] for policy in POLICIES}
            for seed in SEEDS:
                placement = simmpp.place(workload, PROCESSORS, memory, rules, seed=seed)
                results = {p: simmpp.simulate(workload, machine, placement, p) for p in POLICIES}
                base, needed = results["object"], uses(workload, placement)
                for policy, result in results.items():
                    found[policy].append(
                        {
                            "makespan_ms": result.makespan_ps / 1e9,
                            "time_profit": base.makespan_ps / result.makespan_ps,
                            "message_profit": base.messages / max(result.messages, 1),
                            "messages_per_ray": result.messages / workload.n_rays,
                            "uses_per_fetch": needed / max(result.objects_fetched, 1)
                            if policy == "object"
                            else float("nan"),
                        }
                    )
            for policy, drawn in found.items():
                means = {key: f"{np.mean([d[key] for d in drawn]):.4g}" for key in drawn[0]}
                rows.append(
                    {"scene": name, "render": render, "rays": workload.n_rays,
                     "tests": workload.n_tests, "objects": workload.n_objects,
                     "fraction": float(fraction), "kept": float(kept), "policy": policy, **means}
                )  # fmt: skip
                print(rows[-1], flush=True)
    return rows


class Table:
    """The rows, asked by what they are of."""

    def __init__(self, rows: list[Row]) -> None:
        self._rows = rows

    def of(self, column: str, scene: str, render: str, x: float, kept: bool, policy: str) -> float:
        for row in self._rows:
            same = (row["scene"], row["render"], row["policy"]) == (scene, render, policy)
            if same and float(row["fraction"]) == x and (float(row["kept"]) > 0) == kept:
                return float(row[column])
        raise KeyError((column, scene, render, x, kept, policy))

    def profits(self, scene: str, x: float, kept: bool) -> dict[str, float]:
        return {p: self.of("time_profit", scene, "path", x, kept, p) for p in POLICIES}


def expectations(table: Table) -> Iterator[tuple[str, bool, str]]:
    """Which, whether it came out, and in numbers."""

    def fetch(scene: str, render: str, kept: bool = False) -> float:
        return table.of("uses_per_fetch", scene, render, 0.1, kept, "object")

    def ray(scene: str, render: str, x: float) -> float:
        return table.of("time_profit", scene, render, x, False, "ray")

    both, below, kinds = ("mountain:5", "room"), (0.02, 0.1, 0.25), (False, True)
    path, whitted = fetch("room", "path"), fetch("room", "whitted")
    yield "E1", path < 2, f"{path:.2f}"
    yield "E2", whitted >= 2 * path, f"{whitted:.2f} against {path:.2f}"
    path, whitted = fetch("mountain:5", "path"), fetch("mountain:5", "whitted")
    yield "E3", 2 <= path <= 6 and path < whitted, f"{path:.2f}, Whitted's {whitted:.2f}"
    gains = {(s, x): (ray(s, "path", x), ray(s, "whitted", x)) for s in both for x in below}
    told = ", ".join(f"{s} {x:g}: {p:.2f} / {w:.2f}" for (s, x), (p, w) in gains.items())
    yield "E4", all(p > w for p, w in gains.values()), told
    wins = {(s, x, k): table.profits(s, x, k) for s in both for x in below for k in kinds}
    best = {case: max(found, key=lambda p: found[p]) for case, found in wins.items()}
    lost = [f"{s} {x:g} kept {k}" for (s, x, k), policy in best.items() if policy == "object"]
    yield "E5", not lost, f"object dataflow wins: {'; '.join(lost) or 'nowhere'}"
    every = {(s, x, k): table.profits(s, x, k) for s in both for x in (*below, 0.5) for k in kinds}
    least = min(found["concurrent"] for found in every.values())
    near = min(found["concurrent"] / max(found.values()) for found in wins.values())
    yield (
        "E6",
        least >= 1 and near >= 0.95,
        f"least profit {least:.2f}, least of the best {near:.2f}",
    )
    grown = [fetch("room", render, True) / fetch("room", render) for render in ("whitted", "path")]
    yield "E7", grown[0] > grown[1], f"Whitted's x {grown[0]:.2f}, paths' x {grown[1]:.2f}"
    sent = {
        scene: [
            table.of("messages_per_ray", scene, r, 0.1, False, "object")
            for r in ("path", "whitted")
        ]
        for scene in both
    }
    told = ", ".join(f"{s}: {p:.2f} / {w:.2f}" for s, (p, w) in sent.items())
    yield "E8", all(p > w for p, w in sent.values()), told


def draw(table: Table) -> None:
    """Time profits over x."""
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(9, 5), layout="constrained")
        axes = figure.subplots(2, 4, sharex=True, sharey="row")
        columns = [(render, kept) for kept in (False, True) for render in ("whitted", "path")]
        for row, scene in zip(axes, ("mountain:5", "room"), strict=True):
            for axis, (render, kept) in zip(row, columns, strict=True):
                for policy in POLICIES:
                    xs = [float(x) for x in FRACTIONS]
                    ys = [table.of("time_profit", scene, render, x, kept, policy) for x in xs]
                    axis.plot(xs, ys, marker="o", ms=3, color=COLOURS[policy], label=policy)
                axis.set_xscale("log")
                axis.set_xticks([float(x) for x in FRACTIONS], ["2 %", "10 %", "25 %", "50 %"])
                axis.minorticks_off()
                axis.set_title(f"{scene}, {render}{', x kept' if kept else ''}", fontsize=8)
        axes[0, 0].legend(fontsize=7, loc=(0.55, 0.28))
        figure.supxlabel("share x of the scene on each PE", fontsize=9)
        figure.supylabel("time profit over object dataflow", fontsize=9)
        save(figure, HERE / "path")


def main() -> None:
    """Simulate unless it was, judge, draw."""
    file = HERE / "path.csv"
    if not file.exists():
        rows = [row for (n, r), scene in scenes().items() for row in rows_of(scene, n, r)]
        write_csv(rows, list(rows[0]), file)
    with file.open() as lines:
        table = Table(list(csv.DictReader(lines)))
    judged = [
        {"expectation": name, "came_out": "yes" if did else "no", "found": found}
        for name, did, found in expectations(table)
    ]
    for line in judged:
        print(line)
    write_csv(judged, list(judged[0]), HERE / "expected.csv")
    draw(table)


if __name__ == "__main__":
    main()
