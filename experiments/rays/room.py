"""Dataflows on the radiosity of a room: judges what was expected, and draws.

    python experiments/rays/room.py

Sweeps gathering.yaml and shooting.yaml unless their rows (gathering.csv, shooting.csv) are there,
writes room-expected.csv (each expectation of README.md and what came out) and room.png.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import matplotlib
import pandas as pd
from matplotlib.figure import Figure

import simmpp
from simmpp.common.files import write_csv
from simmpp.plot.matplotlib_panels import SETTINGS, save

HERE = Path(__file__).parent
POLICIES = ("object", "ray", "concurrent")
WAYS = ("home", "interleaved")
BELOW = (0.02, 0.1, 0.25)
COLOURS = {"object": "#d55e00", "ray": "#0072b2", "concurrent": "#009e73"}
AXES = ["fraction", "memory.transient", "placement.pixels", "placement.rounds"]
TIMES = ["residual_tenth_ps", "residual_hundredth_ps"]
MEASURES = ["makespan_ps", "messages", "compute_ps", *TIMES]
PROCESSORS, WINDOW = 64, '{"window": 8}'
Expected = tuple[str, bool, str]


def rows_of(name: str) -> pd.DataFrame:
    """Means over seeds of each place and policy, from the file or simulated."""
    file = HERE / f"{name}.csv"
    if not file.exists():
        rows, _ = simmpp.sweep(HERE / f"{name}.yaml")
        keys = [key for key in AXES if key in rows]
        groups = rows.groupby([*keys, "policy"], as_index=False, sort=True)
        kept = [column for column in MEASURES if column in rows]
        means = groups[kept].mean()
        means[kept] = means[kept].round().astype("int64")
        means.to_csv(file, index=False)
    return pd.read_csv(file)


class Rows:
    """Asked by what they are of."""

    def __init__(self, name: str) -> None:
        self._rows = rows_of(name)

    def of(self, column: str, policy: str, x: float, **where: object) -> float:
        found = self._rows[(self._rows.policy == policy) & (self._rows.fraction == x)]
        for key, value in where.items():
            found = found[found[key].astype(str) == str(value)]
        (value,) = found[column]
        return float(value)

    def profit(self, policy: str, x: float, **where: object) -> float:
        both = (self.of("makespan_ps", p, x, **where) for p in ("object", policy))
        return next(both) / next(both)

    def efficiency(self, policy: str, x: float, **where: object) -> float:
        times = (self.of(c, policy, x, **where) for c in ("compute_ps", "makespan_ps"))
        return next(times) / (next(times) * PROCESSORS)


def kept(share: str) -> dict[str, object]:
    return {"memory.transient": share}


def at(way: str, rounds: str = "barrier") -> dict[str, object]:
    return {"placement.pixels": way, "placement.rounds": rounds}


def of_gathering(rows: Rows) -> Iterator[Expected]:
    """Which, whether it came out, and in numbers."""
    gains = {x: {p: rows.profit(p, x, **kept("0")) for p in POLICIES} for x in (*BELOW, 0.5)}
    best = {x: max(gains[x], key=lambda p: gains[x][p]) for x in BELOW}
    told = "; ".join(f"{x:.0%}: {best[x]} {max(gains[x].values()):.2f}" for x in BELOW)
    yield "G1", set(best.values()) == {"ray"}, told
    efficiency = rows.efficiency("ray", 0.02, **kept("0"))
    yield "G2", efficiency >= 0.5, f"{efficiency:.0%}"
    parts = [gains[x]["concurrent"] / gains[x]["ray"] for x in (0.02, 0.1)]
    yield "G3", all(0.5 <= part <= 0.95 for part in parts), ", ".join(f"{p:.2f}" for p in parts)
    without, with_room = (rows.of("makespan_ps", "object", 0.1, **kept(k)) for k in ("0", "10%"))
    yield "G4", with_room <= 0.9 * without, f"{with_room / without:.2f} of the time"


def of_shooting(rows: Rows, gathering: Rows) -> Iterator[Expected]:
    """Likewise."""
    alone = {x: rows.efficiency("object", x, **at("home")) for x in BELOW}
    yield "S1", max(alone.values()) < 2 / PROCESSORS, f"at most {max(alone.values()):.1%}"
    gains = {(x, w): rows.profit("ray", x, **at(w)) for x in (0.02, 0.1) for w in WAYS}
    yield "S2", min(gains[x, "home"] for x in (0.02, 0.1)) >= 3, _told(gains)
    yield "S3", gains[0.1, "interleaved"] < gains[0.1, "home"] / 2, _told(gains)
    best = max(rows.efficiency(p, 0.1, **at(w)) for p in POLICIES for w in WAYS)
    other = max(gathering.efficiency(p, 0.1, **kept("0")) for p in POLICIES)
    yield "S4", best < other / 2, f"{best:.1%} against {other:.1%}"
    fastest = [
        min(rows.of("makespan_ps", p, 0.1, **at(w, r)) for p in POLICIES for w in WAYS)
        for r in ("barrier", WINDOW)
    ]
    yield "S5", fastest[0] >= 1.5 * fastest[1], f"{fastest[0] / fastest[1]:.2f} times as fast"
    spans = []
    for x in (*BELOW, 0.5):
        for way in WAYS:
            times = [
                rows.of("residual_tenth_ps", p, x, **at(way))
                / rows.of("residual_hundredth_ps", p, x, **at(way))
                for p in POLICIES
            ]
            spans.append(max(times) / min(times) - 1)
    yield "S6", max(spans) <= 0.1, f"at most {max(spans):.1%} apart"


def of_paper(gathering: Rows, shooting: Rows) -> Iterator[Expected]:
    """Likewise."""
    xs = (*BELOW, 0.5)
    gains = [gathering.profit("concurrent", x, **kept(k)) for x in xs for k in ("0", "10%")]
    gains += [
        shooting.profit("concurrent", x, **at(w, r))
        for x in xs for w in WAYS for r in ("barrier", WINDOW)
    ]  # fmt: skip
    yield "P1", min(gains) >= 1, f"at least {min(gains):.2f}"


def _told(gains: dict[tuple[float, str], float]) -> str:
    return ", ".join(f"{x:.0%} {way}: {gain:.2f}" for (x, way), gain in gains.items())


def draw(gathering: Rows, shooting: Rows) -> None:
    """Time profits over x."""
    xs = (*BELOW, 0.5)
    panels = [
        ("gathering, nothing kept", gathering, kept("0")),
        ("gathering, 10 % kept", gathering, kept("10%")),
        ("shooting from home", shooting, at("home")),
        ("shooting, dealt to all", shooting, at("interleaved")),
    ]
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(9, 2.8), layout="constrained")
        for axis, (title, rows, where) in zip(figure.subplots(1, 4), panels, strict=True):
            for policy in POLICIES:
                ys = [rows.profit(policy, x, **where) for x in xs]
                axis.plot(xs, ys, marker="o", ms=3, color=COLOURS[policy], label=policy)
            axis.set_xscale("log")
            axis.set_xticks(xs, [f"{100 * x:.0f} %" for x in xs])
            axis.minorticks_off()
            axis.set_ylim(bottom=0)
            axis.set_title(title, fontsize=8)
        figure.axes[0].legend(fontsize=7)
        figure.supxlabel("share x of the patches on each PE", fontsize=9)
        figure.supylabel("time profit", fontsize=9)
        save(figure, HERE / "room")


def main() -> None:
    """Simulate unless it was, judge, draw."""
    gathering, shooting = Rows("gathering"), Rows("shooting")
    found = [
        *of_gathering(gathering), *of_shooting(shooting, gathering), *of_paper(gathering, shooting)
    ]  # fmt: skip
    judged = [
        {"expectation": name, "came_out": "yes" if did else "no", "found": told}
        for name, did, told in found
    ]
    for line in judged:
        print(line)
    write_csv(judged, list(judged[0]), HERE / "room-expected.csv")
    draw(gathering, shooting)


if __name__ == "__main__":
    main()
