"""The generators against files written by the SPD's own programs."""

import hashlib
import math
import re
from pathlib import Path

import pytest

from simmpp.common.errors import ConfigError
from simmpp.scene.nff import read_nff
from simmpp.scene.scene import Polygon
from simmpp.scene.spd.generators import GENERATORS, find_generator, nff

GOLDEN = Path(__file__).parents[2] / "golden" / "spd"
FILES = sorted(GOLDEN.glob("*.nff"))
SUMS = dict(
    reversed(line.split()) for line in (GOLDEN / "SHA256SUMS").read_text().splitlines() if line
)
SMALL = [("balls", 2), ("gears", 2), ("jacks", 2), ("lattice", 3), ("mountain", 3)]
SMALL += [("rings", 2), ("tetra", 3), ("tree", 4)]


def generated(stem: str) -> str:
    name, size = stem.split("_")
    return nff(name, int(size))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_text_is_the_spds_own_byte_for_byte(file: Path) -> None:
    assert generated(file.stem).encode() == file.read_bytes()


@pytest.mark.parametrize("name", sorted(SUMS))
def test_sha256_of_the_spds_files(name: str) -> None:
    assert hashlib.sha256(generated(Path(name).stem).encode()).hexdigest() == SUMS[name]


def test_all_generators_are_covered_by_golden_files() -> None:
    covered = {find_generator(file.stem.split("_")[0]).name for file in FILES}
    assert covered == set(GENERATORS)


@pytest.mark.parametrize(("name", "size"), SMALL)
def test_number_of_objects_follows_the_formula(name: str, size: int) -> None:
    for n in range(1, size + 1):
        text = nff(name, n)
        assert len(re.findall(r"^[scp] ", text, re.M)) == GENERATORS[name].objects(n)


@pytest.mark.parametrize(
    ("name", "size", "count"),
    [
        ("mountain", 6, 8196),
        ("rings", 7, 8401),
        ("tetra", 6, 4096),
        ("balls", 4, 7382),
        ("gears", 4, 9345),
        ("tree", 11, 8191),
        ("lattice", 12, 8281),
        ("jacks", 1, 9),
    ],
)
def test_published_counts_at_the_default_sizes(name: str, size: int, count: int) -> None:
    """Haines 1987, table of the SPD's README; lights and view not counted."""
    assert GENERATORS[name].default_size == size
    assert GENERATORS[name].objects(size) == count


def heights(size: int) -> dict[tuple[float, float], float]:
    """Height of each vertex of a mountain."""
    scene = read_nff(nff("mountain", size), name="", where="")
    found = {}
    for item in scene.objects:
        if isinstance(item, Polygon):
            for x, y, z in item.vertices.tolist():
                assert found.setdefault((x, y), z) == z, "a crack"
    return found


def test_mountains_are_nested_and_have_no_cracks() -> None:
    for size in range(1, 5):
        coarse, fine = heights(size), heights(size + 1)
        assert len(coarse) == (2**size + 1) ** 2
        assert all(fine[point] == z for point, z in coarse.items())


def test_every_other_gear_is_turned_by_half_a_tooth() -> None:
    scene = read_nff(nff("gears", 2), name="", where="")
    tops = [p.vertices for p in scene.objects if isinstance(p, Polygon) and len(p.vertices) == 144]
    angles = []
    for outline in tops[::2]:  # top faces; the bottom ones follow them
        x, y, _ = outline[0] - outline.mean(axis=0)
        angles.append(round(math.degrees(math.atan2(y, x)), 1))
    assert angles == [-1.9, 3.1, 3.1, -1.9, 3.1, -1.9, -1.9, 3.1]


@pytest.mark.parametrize(
    ("name", "size", "problem"),
    [
        ("mountain", 8, "at most 7"),
        ("mountain", 0, "at least 1"),
        ("tetra", 10, "1,048,576 objects"),
        ("balls", 7, "5,380,841 objects"),
        ("tree", 10**9, "far too many objects"),
        ("rings", -3, "at least 1"),
        ("rings", 2.0, "whole number"),
        ("rings", True, "whole number"),
    ],
)
def test_sizes_out_of_range_are_refused(name: str, size: int, problem: str) -> None:
    with pytest.raises(ConfigError, match=problem):
        nff(name, size)


def test_names_as_the_spd_spells_them() -> None:
    assert nff("mount", 2) == nff("mountain", 2)
    assert nff("sphereflake", 1) == nff("balls", 1)
    assert nff("jacks") == nff("jacks", 1)
    with pytest.raises(ConfigError, match="unknown SPD scene 'mont'; known: balls, gears"):
        nff("mont", 1)
