"""``simmpp scene``: what a scene holds, as a list, as NFF, as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.inputs import config_of
from simmpp.commands.parts.tables import texts
from simmpp.commands.parts.terminal import OBJECTS_SHOWN, at_work, go_on, say, wrote
from simmpp.common.files import write_text
from simmpp.common.units import counted, format_bytes
from simmpp.config.config import Config
from simmpp.scene.describe import describe, object_table
from simmpp.scene.nff import write_nff
from simmpp.scene.scene import Scene
from simmpp.workload.picture import Picture
from simmpp.workload.sources import scene_of

PREVIEW_RESOLUTION = 512
MATERIALS_SHOWN, LIGHTS_SHOWN, CAMERAS_SHOWN = 20, 10, 10


@click.command(
    "scene",
    epilog=options.examples(
        "simmpp scene mountain:4 --preview mountain4.png",
        "simmpp scene mountain:4 --nff mountain4.nff",
    ),
)
@click.argument("spec")
@options.setting(
    "Set a dotted key of the configuration, such as scene.camera.angle=30; repeatable."
)
@options.path("--nff", "Write the scene as NFF.")
@options.path("--preview", "Write a picture of it as PNG.")
@click.option("--objects", "all_objects", is_flag=True, help="List every object, however many.")
@options.no_code
def scene_command(
    spec: str,
    overrides: tuple[str, ...],
    nff: Path | None,
    preview: Path | None,
    all_objects: bool,
    may_run: bool,
) -> None:
    """List the objects and materials of a scene.

    SPEC is mountain:5, rings:1, ... (a generator of the SPD and its size), a configuration (.yaml),
    or a file: NFF, or a mesh, which :nodes, :components, :groups or :K (clusters of at most K
    triangles) after its name cuts.
    """
    options.writable(nff, "--nff", ".nff")
    options.writable(preview, "--preview", ".png")
    config = config_of(spec, overrides, may_run=may_run)
    with at_work(f"reading {spec}"):
        scene = scene_of(config.ray_source, "scene")()
    _list(scene, None if all_objects else OBJECTS_SHOWN)
    if nff:
        write_text(write_nff(scene), nff)
    if preview:
        _preview(scene, config, preview)
    wrote(*filter(None, (nff, preview)))
    if nff:
        go_on("run", "CONFIG", "--set", f"scene={nff}")


def _list(scene: Scene, most_objects: int | None) -> None:
    """Print counts, camera, lights, materials and objects; the first ones of a long list."""
    facts = describe(scene)
    say("\n".join(_facts(facts)))
    say()
    _print(facts["materials"], MATERIALS_SHOWN if most_objects else None)
    objects = object_table(scene)
    rows = objects if most_objects is None else objects.head(most_objects)
    say()
    _print(rows.to_dict("records"))
    if len(rows) < len(objects):
        say(f"... and {len(objects) - len(rows)} more objects; --objects lists all")


def _facts(facts: dict[str, Any]) -> list[str]:
    """Lines about the scene as a whole."""
    kinds = ", ".join(counted(count, kind) for kind, count in facts["objects"].items())
    camera = facts["camera"]
    lines = [
        f"{facts['name']}: {counted(facts['n_objects'], 'object')} ({kinds or 'empty'}), "
        f"{counted(facts['triangles'], 'triangle')}, {format_bytes(facts['bytes'])}",
        f"{facts['reflecting']} reflect, {facts['transmitting']} transmit",
        f"camera at {_vector(camera['eye'])} towards {_vector(camera['at'])}, "
        f"up {_vector(camera['up'])}, {camera['angle_degrees']:g} degrees",
        facts["view"],
    ]
    if len(facts["cameras"]) > 1:
        names = [f"{number} ({name!r})" for number, name in enumerate(facts["cameras"])]
        rest = [f"... {len(names) - CAMERAS_SHOWN} more"] if len(names) > CAMERAS_SHOWN else []
        lines.append(f"cameras: {', '.join(names[:CAMERAS_SHOWN] + rest)}")
    lines += facts["notes"]
    if facts["n_objects"]:
        low, high = _vector(facts["box"]["low"]), _vector(facts["box"]["high"])
        lines.append(f"box from {low} to {high}")
    lines += [f"light at {_vector(light['position'])}" for light in facts["lights"][:LIGHTS_SHOWN]]
    if len(facts["lights"]) > LIGHTS_SHOWN:
        lines.append(f"... and {len(facts['lights']) - LIGHTS_SHOWN} more lights")
    return lines


def _vector(vector: list[float]) -> str:
    return "(" + ", ".join(f"{x:g}" for x in vector) + ")"


def _print(rows: list[dict[Any, Any]], most: int | None = None) -> None:
    """Print rows as a table; beyond ``most`` only their number."""
    names = list(rows[0]) if rows else []
    cells = [[_cell(value) for value in row.values()] for row in rows[:most]]
    say(texts(names, cells, whole=len(names)))
    if most is not None and len(rows) > most:
        say(f"... {len(rows) - most} more")


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:g}"
    return _vector(value) if isinstance(value, list) else str(value)


def _preview(scene: Scene, config: Config, path: Path) -> None:
    """The picture of the scene's camera, in the shape that the configuration gives it."""
    # Only --preview traces, which needs numba.
    from simmpp.commands.parts.tracing import workload_of_scene
    from simmpp.workload.trace.shading import render, save_png

    rows, columns = config.picture.of(scene).pixels
    scale = PREVIEW_RESOLUTION / max(rows, columns)
    sides = (max(1, round(columns * scale)), max(1, round(rows * scale)))
    picture = Picture(resolution=sides)
    save_png(render(scene, picture, workload_of_scene(scene, picture)), path)
