"""Draws the pictures of a run as PNG and SVG, readable in print and by the colour-blind."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from simmpp.common.units import format_bytes, format_ps
from simmpp.machine.messages import MESSAGE_KINDS
from simmpp.plot.matplotlib_panels import SETTINGS, STYLES, save
from simmpp.report.run_figures.data import Motion
from simmpp.report.run_figures.torus import draw_torus
from simmpp.report.run_figures.tree import draw_tree

BLUE, VERMILION, GREEN, _, ORANGE, *_ = (style["color"] for style in STYLES)
ACTIVITIES = {"compute_ps": BLUE, "communication_ps": ORANGE, "waiting_ps": "#EDEDED"}
"""Colours of Okabe and Ito (2008); waiting is light: both stand out from it in print too."""
AMOUNTS = "cividis"
"""Colours of amounts: made for the colour-blind (Nunez et al. 2018), and monotonous in grey."""
MS = 1e-9
"""Picoseconds to milliseconds."""


def draw_picture(name: str, motion: Motion, folder: Path) -> list[Path]:
    """Write one picture of a run into a folder, as <policy>-<name>.png and .svg; returns these."""
    title = re.sub(r"[^\w.+-]+", "-", motion.title)
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(layout="constrained")
        DRAWINGS[name](figure, motion)
        return save(figure, folder / f"{title}-{name}")


def _activity(figure: Figure, motion: Motion) -> None:
    """What every PE does, over time; beside it, its shares of the whole."""
    figure.set_size_inches(10, 4.6)
    when, shares = figure.subplots(1, 2, sharey=True, width_ratios=[3, 1])
    nb = len(motion.load)
    end_ms = motion.makespan_ps * MS
    when.imshow(
        _mixed(motion), aspect="auto", interpolation="nearest", extent=(0, end_ms, nb - 0.5, -0.5)
    )
    when.set(xlabel="time (ms)", ylabel="PE")
    when.set_title(f"{motion.title}: what every PE does (makespan {format_ps(motion.makespan_ps)})")
    when.yaxis.set_major_locator(MaxNLocator(integer=True))
    left = np.zeros(nb)
    for name, color in ACTIVITIES.items():
        percent = 100 * getattr(motion, name).sum(axis=1) / max(motion.makespan_ps, 1)
        label = name.removesuffix("_ps")
        shares.barh(np.arange(nb), percent, 1, left, color=color, label=label, linewidth=0)
        left += percent
    shares.set(xlabel="share of the makespan (%)", xlim=(0, 100))
    figure.legend(loc="outside lower center", ncols=3, frameon=False)


def _mixed(motion: Motion) -> NDArray[np.uint8]:
    """Colours of the three activities by their share of each bin: (nb, bins, 3) uint8."""
    whole_ps = np.maximum(np.diff(motion.times_ps), 1)[None, :, None]
    colours = [
        getattr(motion, name)[:, :, None] / whole_ps * np.array(matplotlib.colors.to_rgb(color))
        for name, color in ACTIVITIES.items()
    ]
    mixed = np.sum(colours, axis=0, dtype=np.float64).clip(0, 1)
    return (255 * mixed).round().astype(np.uint8)


def _progress(figure: Figure, motion: Motion) -> None:
    """How busy the machine is and how far, and how large the batches of rays are, over time."""
    figure.set_size_inches(6.3, 5.4)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[3, 2])
    edges = motion.times_ps * MS
    upper.stairs(100 * motion.utilisation, edges, color=BLUE, label="PEs busy")
    done = np.append(0, motion.completion) * 100
    upper.plot(edges, done, color=VERMILION, linestyle="--", label="rays finished")
    for height, (share, time_ps) in zip((25, 50, 75), motion.marks_ps.items(), strict=True):
        upper.axvline(time_ps * MS, color="0.45", linewidth=0.8, linestyle=(0, (2, 2)))
        upper.annotate(
            f"{share} %", (time_ps * MS, height), rotation=90, ha="right", va="center",
            fontsize=7, bbox={"color": "w", "pad": 0.6, "alpha": 0.8},
        )  # fmt: skip
    upper.set(ylabel="share (%)", ylim=(0, 103), xlim=(0, max(edges[-1], 1e-9)))
    upper.set_title(f"{motion.title}: utilisation and completion, in {len(done) - 1} parts")
    figure.legend(loc="outside upper center", ncols=2, frameon=False)
    sent, rays, most = motion.batches
    middles = (edges[1:] + edges[:-1]) / 2
    has = sent > 0
    lower.plot(middles[has], rays[has] / sent[has], ".", markersize=3, label="mean", color=BLUE)
    lower.plot(middles[has], most[has], "_", markersize=4, label="largest", color=VERMILION)
    lower.set(xlabel="time (ms)", ylabel="rays in a message")
    if has.any():
        lower.set_yscale("log")
        lower.grid(axis="y", color="0.9")
        lower.legend(frameon=False, ncols=2)
    else:
        lower.set_yticks([])
        lower.text(0.5, 0.5, "no rays were sent", ha="center", transform=lower.transAxes)


def _traffic(figure: Figure, motion: Motion) -> None:
    """Who sent how much to whom; how large messages are, and how far they go."""
    figure.set_size_inches(10, 4.4)
    grid = figure.add_gridspec(2, 2, width_ratios=[1.15, 1])
    matrix = figure.add_subplot(grid[:, 0])
    kilobytes = np.ma.masked_equal(motion.bytes / 1000, 0)
    image = matrix.imshow(kilobytes, cmap=AMOUNTS, interpolation="nearest", norm=_scale(kilobytes))
    matrix.set(xlabel="to PE", ylabel="from PE", title=f"{motion.title}: bytes sent")
    matrix.set_facecolor("0.93")
    for axis in (matrix.xaxis, matrix.yaxis):
        axis.set_major_locator(MaxNLocator(integer=True))
    figure.colorbar(image, ax=matrix, label="kB (grey: none)")
    sizes = figure.add_subplot(grid[0, 1])
    for kind, counts in enumerate(motion.sizes):
        there = np.flatnonzero(counts)
        style = STYLES[kind] | {"linestyle": "none", "markersize": 5}
        if len(there):
            sizes.plot(there, counts[there], label=MESSAGE_KINDS[kind], **style)
    powers = np.flatnonzero(motion.sizes.any(axis=0))
    if len(powers):
        sizes.set_yscale("log")
        sizes.set_xticks(powers, [_bytes_below(int(d)) for d in powers], fontsize=7)
        sizes.set(xlim=(powers[0] - 0.7, powers[-1] + 0.7), ylim=(0.7, 3 * motion.sizes.max()))
        sizes.legend(frameon=False, fontsize=7)
    sizes.grid(axis="y", color="0.9")
    sizes.set(xlabel="bytes with header, less than", ylabel="messages")
    far = figure.add_subplot(grid[1, 1])
    far.bar(np.arange(len(motion.hops)), motion.hops, color=BLUE)
    far.set(xlabel="links crossed", ylabel="messages", ylim=(0, None if motion.hops.any() else 1))
    if not motion.hops.any():
        for axes in (matrix, sizes, far):
            axes.text(0.5, 0.5, "no messages", ha="center", transform=axes.transAxes)
    far.xaxis.set_major_locator(MaxNLocator(integer=True))


def _scale(amounts: Any) -> Any:
    """Colours by the logarithm where amounts differ by more than a factor of 100."""
    values = amounts.compressed()
    if len(values) == 0 or values.max() <= 100 * values.min():
        return matplotlib.colors.Normalize(0, values.max() if len(values) else 1)
    return matplotlib.colors.LogNorm(values.min(), values.max())


def _bytes_below(digits: int) -> str:
    n = 1 << digits
    return f"{n >> 20}M" if n >> 20 else f"{n >> 10}k" if n >> 10 else f"{n}"


def _memory(figure: Figure, motion: Motion) -> None:
    """What every PE holds at most."""
    figure.set_size_inches(7.5, 4.1)
    axes = figure.subplots()
    pes, bottom = np.arange(len(motion.load)), np.zeros(len(motion.load))
    parts = {
        "resident objects": (motion.resident_bytes, BLUE, ""),
        "fetched objects, at most": (motion.transient_bytes, ORANGE, ""),
        "rays held, at most": (motion.queue_bytes, GREEN, "////"),
    }
    for label, (amounts, color, hatch) in parts.items():
        megabytes = amounts / 1e6
        axes.bar(pes, megabytes, 0.95, bottom, label=label, color=color, hatch=hatch)
        bottom += megabytes
    axes.plot(pes, motion.peak_bytes / 1e6, "k_", markersize=5, label="all at once, at most")
    axes.set(xlabel="PE", ylabel="MB", ylim=(0, 1.25 * max(bottom.max(), 1e-9)))
    axes.set_title(f"{motion.title}: memory of every PE")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend(frameon=False, ncols=2, fontsize=8, loc="upper center")


def _fullest(figure: Figure, motion: Motion) -> None:
    """What the fullest PE holds over time, its parts over each other, and the capacity."""
    fullest = motion.fullest
    if fullest is None:
        raise ValueError("expected a run on PEs whose memory has a capacity")
    figure.set_size_inches(7.5, 4.1)
    axes, edges = figure.subplots(), motion.times_ps * MS
    bottom = np.zeros(len(edges) - 1)
    parts: dict[str, tuple[Any, str, str]] = {
        "objects for good": (fullest.resident, BLUE, ""),
        "kept free: requests, escape": (fullest.kept_free, "0.8", ""),
        "fetched objects": (fullest.fetched, ORANGE, ""),
        "rays, started and to come": (fullest.rays, GREEN, "////"),
        "rays received": (fullest.unread, VERMILION, "...."),
    }
    for label, (amount, color, hatch) in parts.items():
        top = bottom + amount / 1e3
        style: Any = {"color": color, "hatch": hatch, "edgecolor": "white", "linewidth": 0}
        axes.stairs(top, edges, baseline=bottom, fill=True, label=label, **style)
        bottom = top
    capacity, most = fullest.capacity_bytes / 1e3, max(bottom.max(), 1e-9)
    if capacity <= 2 * most:
        axes.axhline(capacity, color="k", linestyle="--", linewidth=1, label="capacity")
    axes.set(xlabel="time (ms)", ylabel="kB", ylim=(0, 1.35 * max(most, min(capacity, 2 * most))))
    axes.set_xlim(0, max(edges[-1], 1e-9))
    told = f"PE {fullest.pe}, the fullest, with {format_bytes(fullest.capacity_bytes)}"
    axes.set_title(f"{motion.title}: memory of {told}")
    axes.legend(frameon=False, ncols=3, fontsize=8, loc="upper center")


def _pixels(figure: Figure, motion: Motion) -> None:
    """What pixels cost, how far their rays and objects went, and whose they are."""
    picture = motion.picture
    figure.set_size_inches(10 if picture is None else 13, 3.4)
    axes = list(figure.subplots(1, 3 if picture is None else 4))
    if picture is not None:
        rendered = axes.pop(0)
        rendered.imshow(picture, interpolation="nearest")
        rendered.set_title("picture")
        rendered.set_axis_off()
    maps = {
        "cost (us)": motion.pixel_cost_ps / 1e6,
        "links crossed for its rays": motion.pixel_hops,
        "PE it starts on": motion.pixel_owner,
    }
    for here, (title, values) in zip(axes, maps.items(), strict=True):
        image = here.imshow(values, cmap=AMOUNTS, interpolation="nearest")
        here.set_title(f"{motion.title}: {title}" if here is axes[0] else title)
        here.set_axis_off()
        rows, columns = values.shape
        figure.colorbar(image, ax=here, shrink=0.85 * min(1.0, rows / columns))


DRAWINGS: dict[str, Callable[[Figure, Motion], None]] = {
    "activity": _activity,
    "progress": _progress,
    "torus": draw_torus,
    "links": draw_tree,
    "traffic": _traffic,
    "memory": _memory,
    "fullest": _fullest,
    "pixels": _pixels,
}
"""Each picture by its name, those of networks included."""
