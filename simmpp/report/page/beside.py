"""Pictures and tables that others left in the folder: of single runs, of a sensitivity analysis."""

from __future__ import annotations

import base64
import csv
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from simmpp.report.page.figures.groups import FIGURE_GROUPS
from simmpp.report.page.folder import undamaged

TOPICS = {"sensitivity": "Sensitivity"}
"""Stems of files, as a whole or to the first hyphen, and what they are about."""
PICTURES = {".svg": "image/svg+xml", ".png": "image/png"}
"""Kinds of pictures."""
OWN = tuple(stem for group in FIGURE_GROUPS for stem in group.stems)
"""A report's own figures, which may be those of an earlier one."""
FIGURES_FOLDER = "figures"
"""Where a report writes its figures, and `run --figures` may have written others."""
MOST_LINES = 200
"""Lines of a table that are shown."""
MOST_PICTURE_BYTES = 1_500_000
"""Size of a picture that is put into the page."""


@dataclass(frozen=True)
class EmbeddedPicture:
    """A picture, in the page itself."""

    name: str
    data: str
    """Its bytes as a ``data:`` address."""


@dataclass(frozen=True)
class CsvTable:
    """A CSV file, as it is."""

    name: str
    header: list[str]
    rows: list[list[str]]


class Section(NamedTuple):
    """What there is on one topic."""

    id: str
    name: str
    pictures: list[EmbeddedPicture]
    tables: list[CsvTable]


def beside(folder: Path) -> list[Section]:
    """Sections for each topic, and for the pictures in ``figures`` that no report made."""
    sections = []
    for topic, name in TOPICS.items():
        stems = [topic, f"{topic}-*"]
        tables = [_table(path) for path in _matching(folder, [f"{stem}.csv" for stem in stems])]
        sections.append(Section(topic, name, _pictures(folder, stems), tables))
    others = [p for p in _pictures(folder / FIGURES_FOLDER, ["*"]) if not p.name.startswith(OWN)]
    sections.append(Section("runs", "Pictures of single runs", others, []))
    return [section for section in sections if section.pictures or section.tables]


def _matching(folder: Path, patterns: Iterable[str]) -> list[Path]:
    return sorted({path for pattern in patterns for path in folder.glob(pattern)})


def _pictures(folder: Path, stems: Iterable[str]) -> list[EmbeddedPicture]:
    """Of each stem the smaller file, as text of the page."""
    patterns = [f"{stem}{suffix}" for stem in stems for suffix in PICTURES]
    smallest: dict[str, Path] = {}
    for path in sorted(_matching(folder, patterns), key=lambda path: -path.stat().st_size):
        if path.stat().st_size <= MOST_PICTURE_BYTES:
            smallest[path.stem] = path  # the largest come first, so the smallest stays
    return [_picture(smallest[stem]) for stem in sorted(smallest)]


def _picture(path: Path) -> EmbeddedPicture:
    encoded = base64.b64encode(path.read_bytes()).decode()
    return EmbeddedPicture(path.stem, f"data:{PICTURES[path.suffix]};base64,{encoded}")


def _table(path: Path) -> CsvTable:
    with undamaged(path), open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    more = len(rows) - 1 - MOST_LINES
    name = f"{path.name}, {MOST_LINES} of {len(rows) - 1} rows" if more > 0 else path.name
    return CsvTable(name, rows[0] if rows else [], rows[1 : MOST_LINES + 1])
