"""``simmpp machine``: every constant of a preset with its source."""

from __future__ import annotations

import click

from simmpp.commands.options import examples


@click.command("machine", epilog=examples("simmpp machine t3e"))
@click.argument("preset")
def machine_command(preset: str) -> None:
    """Print every constant of a machine with its source.

    PRESET is t3e, t3d, bluegene-l, xe6-hopper or tpu-v4. A constant without a document says
    ESTIMATE and the range it may lie in.
    """
    from rich.table import Table

    from simmpp.commands.terminal import output
    from simmpp.machine.presets import load_preset
    from simmpp.machine.torus import LINKS, NO_CONTENTION

    chosen = load_preset(preset)
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("constant", no_wrap=True)
    table.add_column("value", no_wrap=True)
    table.add_column("source")
    for key, text in chosen.texts.items():
        table.add_row(key, text, chosen.sources[key])
    table.add_row(
        "contention",
        NO_CONTENTION,
        f"a choice, not a constant; {LINKS}: each link and port serves one message at a time",
    )
    console = output()
    console.print(f"{chosen.name}: {chosen.description}\n", markup=False, highlight=False)
    console.print(table)
