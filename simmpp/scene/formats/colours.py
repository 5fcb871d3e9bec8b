"""Colours of mesh files: shares or bytes, made one colour of a surface."""

from __future__ import annotations

import numpy as np

from simmpp.scene.scene import Floats, Material


def as_bytes(shares: Floats) -> Floats:
    """Shares of 0 ... 1 as whole numbers of 0 ... 255; what is no number counts as black."""
    rounded: Floats = np.round(255 * np.clip(np.nan_to_num(shares, nan=0.0), 0.0, 1.0))
    return rounded


def matt(colours: Floats) -> Material:
    """A matt surface of the mean of colours (n, 3), each of 0 ... 255."""
    red, green, blue = (np.clip(colours, 0, 255).mean(axis=0) / 255).tolist()
    return Material((red, green, blue))
