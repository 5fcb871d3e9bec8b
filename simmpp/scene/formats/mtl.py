"""Wavefront MTL: the diffuse colour of each material; nothing else of it is read."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from simmpp.common.errors import SceneError
from simmpp.scene.formats.colours import as_bytes, matt
from simmpp.scene.formats.text import decoded, named
from simmpp.scene.packed import read_whole
from simmpp.scene.scene import Material


def materials(names: str, folder: Path) -> dict[str, Material | None]:
    """The materials of the files that a ``mtllib`` names, None for one without a colour.

    A file that can't be read has none: geometry and rays are the same without.
    """
    surfaces: dict[str, Material | None] = {}
    # A file's name may hold blanks, or there are several.
    for file in dict.fromkeys((names, *names.split(" "))):
        path = folder / file.replace("\\", "/")
        if os.path.isfile(path):  # which answers where pathlib raises
            surfaces = _read(path) | surfaces
    return surfaces


def _read(path: Path) -> dict[str, Material | None]:
    try:
        text = decoded(read_whole(path))
    except SceneError:
        return {}
    surfaces: dict[str, Material | None] = {}
    name = ""
    for line in text.split("\n"):
        words = line.split()
        keyword = words[0].lower() if words else ""
        if keyword == "newmtl":
            name = named(line.strip()[len(keyword) :])
            surfaces[name] = None
        elif keyword == "kd" and name in surfaces:
            surfaces[name] = _diffuse(words[1:])
    return surfaces


def _diffuse(words: Sequence[str]) -> Material | None:
    """A colour of three numbers, or of one for all three; files of spectra are not read."""
    try:
        shares = list(map(float, words[:3]))
    except ValueError:
        return None
    if len(shares) not in (1, 3):
        return None
    return matt(as_bytes(np.resize(shares, (1, 3))))
