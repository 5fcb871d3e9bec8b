"""Colours of mesh files: shares or bytes, made one colour of a surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simmpp.common.units import shown
from simmpp.scene.scene import Floats, Material


def as_bytes(shares: Floats) -> Floats:
    """Shares of 0 ... 1 as whole numbers of 0 ... 255; what is no number counts as black."""
    rounded: Floats = np.round(255 * np.clip(np.nan_to_num(shares, nan=0.0), 0.0, 1.0))
    return rounded


def matt(colours: Floats) -> Material:
    """A matt surface of the mean of colours (n, 3), each of 0 ... 255."""
    red, green, blue = (np.clip(colours, 0, 255).mean(axis=0) / 255).tolist()
    return Material((red, green, blue))


def of_textures(materials: Sequence[str]) -> str:
    """What is said of materials that have textures."""
    rest = f" and {len(materials) - 1} more" if len(materials) > 1 else ""
    whose = "their colours are" if rest else "its colour is"
    return f"textures of {shown(materials[0])}{rest} are not read: {whose} the one without"
