"""What rows are of: scenes, machine, configuration, versions and how long it took."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from simmpp.common.units import counted
from simmpp.report.page.folder import Folder, number_of
from simmpp.report.page.settings import settings_of
from simmpp.run import words


def facts(folder: Folder) -> list[str]:
    """One line: scenes, PEs, policies, seeds, rows."""
    rows = folder.rows
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    processors = sorted({row["processors"] for row in rows})
    named = ", ".join(scenes) if len(scenes) <= 4 else counted(len(scenes), "scene")
    if not rows:
        return ["no rows yet"]
    parts = [f"{name}: {part.path}" for name, part in folder.parts.items()]
    many = "processing element (PE)" if processors == [1] else "processing elements (PEs)"
    pes = f"{words.span(processors)} {many}"
    return [
        *parts,
        f"simulated: {named}",
        pes,
        counted(folder.seeds, "seed"),
        counted(len(rows), "row"),
    ]


def origin(folder: Folder) -> list[tuple[str, str]]:
    """Names and values, as text; of several folders those that differ for each."""
    if folder.parts:
        return list(_of_each({name: dict(origin(part)) for name, part in folder.parts.items()}))
    return [*settings_of(folder.record), *_machines(folder), *_versions(folder), *_times(folder)]


def _of_each(origins: Mapping[str, Mapping[str, str]]) -> Iterator[tuple[str, str]]:
    for key in dict.fromkeys(key for of in origins.values() for key in of):
        values = {name: of.get(key, "not given") for name, of in origins.items()}
        if len({*values.values()}) == 1:
            yield key, next(iter(values.values()))
        else:
            yield from ((f"{key}, {name}", value) for name, value in values.items())


def _machines(folder: Folder) -> Iterator[tuple[str, str]]:
    machines = folder.record.get("machines")
    for machine in machines if isinstance(machines, list) else []:
        if isinstance(machine, dict):
            shape = " x ".join(map(str, machine.get("shape") or ()))
            yield "machine", f"{machine.get('name', '')} {shape}".strip()


def _versions(folder: Folder) -> Iterator[tuple[str, str]]:
    versions = folder.record.get("versions")
    if isinstance(versions, dict):
        yield "versions", ", ".join(f"{name} {version}" for name, version in versions.items())


def _times(folder: Folder) -> Iterator[tuple[str, str]]:
    seconds: dict[str, float] = {}
    for row in folder.timings:
        if isinstance(wall_s := number_of(row["wall_s"]), int | float):
            seconds[row["policy"]] = seconds.get(row["policy"], 0.0) + wall_s
    if seconds:
        parts = ", ".join(f"{words.policy(title)} {s:.3g} s" for title, s in seconds.items())
        yield "time to simulate", f"{sum(seconds.values()):.3g} s on one core: {parts}"
