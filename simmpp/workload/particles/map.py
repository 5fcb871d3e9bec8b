"""A map of the cells: how far particles flew in each of a layer, in colours by the logarithm."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.particles.cells import Cells
from simmpp.workload.workload import Workload

Image = NDArray[np.uint8]
LONG, DECADES = 960, 5
"""Pixels along the longer side, about; powers of ten from black to the brightest cell."""
RAMP = np.array(
    [[0, 0, 4], [40, 11, 84], [101, 21, 110], [159, 42, 99], [212, 72, 66], [245, 125, 21],
     [250, 193, 39], [252, 255, 164]], np.float64,
)  # fmt: skip
"""Eight colours of matplotlib's inferno, black to yellow, evenly apart."""


def drawn(cells: Cells, workload: Workload, done: NDArray[np.bool_] | None = None) -> Image:
    """The layer of the source's middle across y: z to the right, x upwards; of roots ``done``.

    Sides that are mirrors show what is behind them.
    """
    layer = _layer(cells, _tracks(workload, done))
    for side, axis, is_low in (
        ("-x", 0, True),
        ("+x", 0, False),
        ("-z", 1, True),
        ("+z", 1, False),
    ):
        if side in cells.mirrors:
            parts = [np.flip(layer, axis), layer]
            layer = np.concatenate(parts if is_low else parts[::-1], axis)
    return _enlarged(_coloured(layer[::-1]), cells)


def _tracks(workload: Workload, done: NDArray[np.bool_] | None) -> NDArray[np.float64]:
    """Weight times length in each cell."""
    deposits = workload.test_deposits.astype(np.float64)
    if done is not None:
        lengths = np.diff(workload.itinerary_offsets)
        deposits = deposits * np.repeat(done[workload.pixels], lengths)
    tracks: NDArray[np.float64] = np.zeros(workload.n_objects)
    tracks += np.bincount(workload.itinerary_objects, deposits, workload.n_objects)
    return tracks


def _layer(cells: Cells, tracks: NDArray[np.float64]) -> NDArray[np.float64]:
    """Along x and z."""
    x, y, z = cells.shape
    low, high = cells.source.low[1], (cells.source.high or cells.source.low)[1]
    at = min(int((low + high) / 2 / cells.size[1] * y), y - 1)
    return tracks.reshape(z, y, x)[:, at].T


def _coloured(values: NDArray[np.float64]) -> Image:
    most = values.max(initial=0.0)
    if not most > 0.0:
        return np.zeros((*values.shape, 3), np.uint8)
    with np.errstate(divide="ignore"):
        height = np.log10(values / most) / DECADES + 1
    place = np.clip(height, 0.0, 1.0) * (len(RAMP) - 1)
    low = np.minimum(place.astype(int), len(RAMP) - 2)
    part = (place - low)[..., None]
    return np.rint(RAMP[low] * (1 - part) + RAMP[low + 1] * part).astype(np.uint8)


def _enlarged(image: Image, cells: Cells) -> Image:
    """Each cell as a rectangle of its shape."""
    width_x, _, width_z = (side / n for side, n in zip(cells.size, cells.shape, strict=True))
    scale = LONG / max(image.shape[0] * width_x, image.shape[1] * width_z)
    down, across = (max(1, round(width * scale)) for width in (width_x, width_z))
    return image.repeat(down, axis=0).repeat(across, axis=1)
