"""Which uncertain constants and open readings decide the profits? Sobol indices, first and total.

    pip install '.[experiments]'
    python experiments/sensitivity/sensitivity.py

Every factor of factors.py is drawn over its range (the scheme of Saltelli 2002, Comput. Phys.
Commun. 145, 280-297, on a scrambled Sobol sequence; indices of Sobol 2001, Math. Comput. Simul. 55,
271-280; both by SALib), object, ray and concurrent dataflow are simulated at each draw, with the
same seed of the placement, and the variance of the logarithm of each ratio is apportioned. Writes
draws.csv (the values of each draw), sensitivity.csv (what was simulated; continues where it was
stopped), indices.csv, levels.csv (means by level or third of a range), reduction.csv (some draws at
full resolution) and the figure.
"""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
from factors import (
    DEFAULT_OBJECT_BYTES,
    FACTORS,
    UNREAD,
    Values,
    machine_of,
    placement_of,
    policy_of,
    values_at,
)
from indices import agreement, draw, indices, levels
from numpy.typing import NDArray
from SALib.sample import sobol

from simmpp.common.files import write_csv
from simmpp.engine.simulate import simulate
from simmpp.plot.matplotlib_panels import save
from simmpp.workload.cache.store import workload_for
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.workload import Workload

HERE = Path(__file__).parent
SCENES = ("mountain:5", "tetra:5")
RESOLUTION, FULL_RESOLUTION = 192, 512
BASE_SAMPLES = 256
"""Draws are BASE_SAMPLES * (factors + 2); any smaller power of two is a prefix of them."""
GROUP = len(FACTORS) + 2
SEED = 1998
"""Of the sequence and of the bootstrap."""
PLACEMENT_SEED = 0
CHECKED = 16
"""Draws that are simulated at FULL_RESOLUTION too."""

Row = dict[str, str | int]
PROBLEM = {
    "num_vars": len(FACTORS),
    "names": [each.name for each in FACTORS],
    "bounds": [[0.0, 1.0]] * len(FACTORS),
}


def draws() -> list[Values]:
    """The values of every draw, in the order that SALib expects results in."""
    sample = sobol.sample(PROBLEM, BASE_SAMPLES, calc_second_order=False, seed=SEED)
    return [values_at(quantiles) for quantiles in sample.tolist()]


class Runs:
    """Simulations on one scene; those that do not differ in what is read are run once."""

    def __init__(self, scene: str, resolution: int) -> None:
        self.scene = scene
        self._workload = workload_for(load_scene(scene), Picture(resolution=resolution))
        self._made: dict[tuple[object, ...], tuple[int, int]] = {}

    def row(self, number: int, values: Values) -> Row:
        """Makespans and messages of the three dataflows at a draw."""
        if number % GROUP == 0:
            self._made.clear()  # draws are alike only within the group of one base sample
        row: Row = {"draw": number, "scene": self.scene}
        for name, unread in UNREAD.items():
            key = (name, *(value for each, value in values.items() if each not in unread))
            if key not in self._made:
                self._made[key] = self._simulate(name, values)
            row[f"{name}_ps"], row[f"{name}_messages"] = self._made[key]
        return row

    def _simulate(self, policy: str, values: Values) -> tuple[int, int]:
        workload = sized(self._workload, float(values["object_bytes"]))
        result = simulate(
            workload,
            machine_of(values),
            placement_of(values, workload, PLACEMENT_SEED),
            policy_of(policy, values),
            ready_order=str(values["ready_order"]),
        )
        return result.makespan_ps, result.messages


def sized(workload: Workload, primitive_bytes: float) -> Workload:
    """The same rays with objects so many times larger that a primitive has ``primitive_bytes``."""
    scaled: NDArray[np.int64] = np.rint(
        workload.object_bytes * (primitive_bytes / DEFAULT_OBJECT_BYTES)
    ).astype(np.int64)
    return replace(workload, object_bytes=scaled)


def read(name: str) -> list[dict[str, str]]:
    """Rows of a CSV beside this script; none if it isn't there."""
    path = HERE / name
    if not path.exists():
        return []
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def write(rows: list[dict[str, object]], name: str) -> None:
    """Write rows as CSV beside this script."""
    write_csv(rows, list(rows[0]), HERE / name)


def simulate_rest(name: str, numbers: list[int], values: list[Values], resolution: int) -> None:
    """Append the rows that ``name`` does not have yet, draw by draw."""
    done = {(int(row["draw"]), row["scene"]) for row in read(name)}
    runs = [Runs(scene, resolution) for scene in SCENES]
    with open(HERE / name, "a", encoding="utf-8", newline="") as file:
        writer = None
        for number in numbers:
            for each in runs:
                if (number, each.scene) in done:
                    continue
                row = each.row(number, values[number])
                if writer is None:
                    writer = csv.DictWriter(file, list(row), lineterminator="\n")
                    if not done:
                        writer.writeheader()
                writer.writerow(row)
            if number % GROUP == GROUP - 1:
                file.flush()
                print(f"{name}: draw {number + 1} of {len(values)}", flush=True)


def checked(values: list[Values]) -> list[int]:
    """Some of the draws, all different: the first of the first groups."""
    return [group * GROUP for group in range(min(CHECKED, len(values) // GROUP))]


def complete(rows: list[dict[str, str]]) -> int:
    """How many draws from the first on are there for all scenes, in whole powers of two."""
    found = {(int(row["draw"]), row["scene"]) for row in rows}
    number = next((n for n in range(len(found) + 1) if any((n, s) not in found for s in SCENES)), 0)
    groups = number // GROUP
    return GROUP * 2 ** (groups.bit_length() - 1) if groups else 0


def main() -> None:
    """Simulate what isn't there yet; apportion the variance; draw."""
    values = draws()
    write([{"draw": n, **each} for n, each in enumerate(values)], "draws.csv")
    simulate_rest("sensitivity.csv", list(range(len(values))), values, RESOLUTION)
    simulate_rest("reduction.csv", checked(values), values, FULL_RESOLUTION)
    report(values)


def report(values: list[Values]) -> None:
    """Tables and figure from the rows that are there."""
    rows = read("sensitivity.csv")
    n_draws = complete(rows)
    of_scene = {
        scene: sorted(
            (row for row in rows if row["scene"] == scene and int(row["draw"]) < n_draws),
            key=lambda row: int(row["draw"]),
        )
        for scene in SCENES
    }
    found = [row for scene in SCENES for row in indices(of_scene[scene], PROBLEM, SEED)]
    write(found, "indices.csv")
    write([row for each in of_scene.values() for row in levels(each, values, GROUP)], "levels.csv")
    note = f"64 PEs, {RESOLUTION} x {RESOLUTION} pixels, {n_draws} draws; bars: 95 % intervals"
    save(draw(found, SCENES, note), HERE / "sensitivity")
    for line in agreement(rows, read("reduction.csv")):
        print(line)


if __name__ == "__main__":
    main()
