"""Wavefront MTL: the colour of each material, and whether it mirrors, lets light through or shines.

Source: Wavefront Technologies, "MTL Material Format", Advanced Visualizer manual, 5.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from simmpp.common.errors import SceneError
from simmpp.common.units import shown
from simmpp.scene.formats.colours import as_bytes, matt, of_textures
from simmpp.scene.formats.text import decoded, named
from simmpp.scene.nff_words import LARGEST
from simmpp.scene.packed import read_whole
from simmpp.scene.scene import Material, Vector

MIRRORS = (3, 4, 5, 6, 7)
"""Values of ``illum`` that have reflected rays; 8 and 9 have reflections, but no rays."""
REFRACTS = (6, 7)
"""Those whose filter ``Tf`` says how much passes, where ``d`` does not."""


class Surface(NamedTuple):
    """A material but for the colour, which may be that of vertices."""

    colour: Vector | None
    ks: float = 0.0
    shine: float = 1.0
    transmittance: float = 0.0
    ior: float = 1.0
    emission: Vector = (0.0, 0.0, 0.0)

    def material(self, colour: Vector) -> Material:
        """With its own colour if it has one, else with ``colour``."""
        kd = 1.0 - self.transmittance
        return Material(self.colour or colour, kd, *self[1:])


class Library(NamedTuple):
    """The materials of one or several files, and what of them was not read."""

    surfaces: dict[str, Surface]
    notes: tuple[str, ...]


def materials(names: str, folder: Path) -> Library:
    """The materials of the files that a ``mtllib`` names.

    A file that can't be read has none: geometry is the same without.
    """
    # A file's name may hold blanks, or there are several.
    whole = os.path.isfile(_path(folder, names))
    surfaces: dict[str, Surface] = {}
    notes: list[str] = []
    for name in [names] if whole else dict.fromkeys(names.split(" ")):
        try:
            found = _read(decoded(read_whole(_path(folder, name))))
        except SceneError as error:
            notes.append(f"mtllib {shown(name)} is left out: {error.problem}")
            continue
        surfaces = {name: _surface(said) for name, said in found.items()} | surfaces
        textured = [name for name, said in found.items() if "map_kd" in said]
        notes += [of_textures(textured)] if textured else []
        notes += [
            f"Kd of {shown(name)} is no colour of one number or three: grey"
            for name, said in found.items()
            if "kd" in said and not _colour(said["kd"])
        ]
    return Library(surfaces, tuple(notes))


def _path(folder: Path, name: str) -> Path:
    return folder / name.replace("\\", "/")


def _read(text: str) -> dict[str, dict[str, list[str]]]:
    """Of each material the words of its statements, the last of each."""
    found: dict[str, dict[str, list[str]]] = {}
    said: dict[str, list[str]] = {}
    for line in text.split("\n"):
        words = line.partition("#")[0].split()
        keyword = words[0].lower() if words else ""
        if keyword == "newmtl":
            said = found[named(line.strip()[len(keyword) :])] = {}
        elif keyword:
            said[keyword] = words[1:]
    return found


def _surface(said: dict[str, list[str]]) -> Surface:
    colour, specular = _colour(said.get("kd")), _colour(said.get("ks"))
    illum, opacity = _number(said, "illum"), _number(said, "d")
    through = _number(said, "tr") if opacity is None else 1.0 - opacity
    if not through and illum in REFRACTS:
        through = _mean(_colour(said.get("tf")))
    transmittance = min(max(through or 0.0, 0.0), 1.0)
    # A highlight alone, as of `illum 2`, needs no ray; what transmits reflects in any case.
    ks = _mean(specular) if illum in MIRRORS or transmittance else 0.0
    shine, ior = _number(said, "ns"), _number(said, "ni")
    return Surface(
        colour,
        ks,
        shine if shine and shine > 0 and ks else 1.0,
        transmittance,
        ior if ior and ior > 0 and transmittance else 1.0,
        _emission(said.get("ke")),
    )


def _number(said: dict[str, list[str]], keyword: str) -> float | None:
    """The last word of a statement, after options such as ``-halo``; None if it is no number."""
    try:
        number = float(said[keyword][-1])
    except (KeyError, IndexError, ValueError):
        return None
    return number if math.isfinite(number) else None


def _emission(words: Sequence[str] | None) -> Vector:
    """Three numbers, or one for all three, however bright; black for what is none.

    Source: P. Bourke, "MTL material format": the extension Ke.
    """
    try:
        shares = list(map(float, (words or ())[:3]))
    except ValueError:
        shares = []
    if len(shares) not in (1, 3) or not all(0 <= share <= LARGEST for share in shares):
        return 0.0, 0.0, 0.0
    red, green, blue = (shares * 3)[:3]
    return red, green, blue


def _mean(colour: Vector | None) -> float:
    return sum(colour) / 3 if colour else 0.0


def _colour(words: Sequence[str] | None) -> Vector | None:
    """A colour of three numbers, or of one for all three; files of spectra are not read."""
    try:
        shares = list(map(float, (words or ())[:3]))
    except ValueError:
        return None
    if len(shares) not in (1, 3):
        return None
    return matt(as_bytes(np.resize(shares, (1, 3)))).colour
