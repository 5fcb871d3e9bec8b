"""``simmpp init``: a configuration to begin with."""

from __future__ import annotations

from pathlib import Path

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.terminal import go_on, wrote
from simmpp.common.errors import ConfigError
from simmpp.common.files import write_text
from simmpp.config.starter import starter

SUFFIXES = (".yaml", ".yml")


@click.command("init", epilog=options.examples("simmpp init", "simmpp init mine.yaml"))
@click.argument("path", metavar="FILE", type=options.NamedPath(), default=Path("simmpp.yaml"))
@click.option("--force", is_flag=True, help="Write over a file that is there.")
def init_command(path: Path, force: bool) -> None:
    """Write a configuration to begin with, each key explained.

    FILE is simmpp.yaml if not given. What it says runs as it is, in some seconds.
    """
    if not path.name.lower().endswith(SUFFIXES):
        raise ConfigError(f"FILE: value {str(path)!r}: expected a file {' or '.join(SUFFIXES)}")
    options.writable(path, "FILE")
    if path.exists() and not force:
        raise ConfigError(f"FILE: value {str(path)!r}: is there already; --force writes over it")
    write_text(starter(), path)
    wrote(path)
    go_on("run", path)
