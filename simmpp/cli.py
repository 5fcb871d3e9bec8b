"""The command line: ``simmpp run``, ``sweep`` and the others; mistakes become one line."""

from __future__ import annotations

import os
import sys
from typing import Any, NoReturn

import click

from simmpp.commands.bench import bench_command
from simmpp.commands.check import check_command
from simmpp.commands.compare import compare_command
from simmpp.commands.keys import keys_command
from simmpp.commands.machine import machine_command
from simmpp.commands.model import model_command
from simmpp.commands.report import report_command
from simmpp.commands.reproduce import reproduce_command
from simmpp.commands.run import run_command
from simmpp.commands.scene import scene_command
from simmpp.commands.sweep import sweep_command
from simmpp.commands.workload import workload_command
from simmpp.common.errors import InputError, ModelError

INPUT_ERROR, MODEL_ERROR, INTERRUPTED, READER_GONE = 2, 70, 130, 141
"""Exit codes: a wrong input, a bug (EX_SOFTWARE of BSD's sysexits), Ctrl-C (128 + SIGINT), and a
pipe that nobody reads any more, as with ``| head`` (128 + SIGPIPE)."""


class Commands(click.Group):
    """The group of commands; whatever simmpp raises on purpose ends it without a traceback."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command named."""
        try:
            return super().invoke(ctx)
        except InputError as error:
            _quit(f"error: {error}", INPUT_ERROR)
        except BrokenPipeError:
            _leave_pipe()
        except OSError as error:
            _quit(f"error: {error.filename or 'output'}: {error.strerror or error}", INPUT_ERROR)
        except ModelError as error:
            _quit(f"this is a bug, please report it: {error}", MODEL_ERROR)
        except KeyboardInterrupt:
            _quit("interrupted", INTERRUPTED)
        except MemoryError:
            _quit("error: out of memory: expected a smaller scene or resolution", INPUT_ERROR)


def _leave_pipe() -> NoReturn:
    """End; what Python still holds for the pipe goes nowhere, or it would complain of that too."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in filter(None, (sys.stdout, sys.stderr)):
        os.dup2(nowhere, stream.fileno())
    sys.exit(READER_GONE)


def _quit(message: str, code: int) -> NoReturn:
    click.echo("simmpp: " + _printable(" ".join(message.splitlines())), err=True)
    sys.exit(code)


def _printable(text: str) -> str:
    """The text with control characters, which names may hold, written out."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="simmpp", prog_name="simmpp")
def main() -> None:
    """Should rays travel to the objects, or objects to the rays?

    Simulates a parallel machine that traces the real rays of a scene that does not fit into the
    memory of one of its processing elements (PEs).
    """


main.add_command(run_command)
main.add_command(sweep_command)
main.add_command(check_command)
main.add_command(bench_command)
main.add_command(compare_command)
main.add_command(keys_command)
main.add_command(machine_command)
main.add_command(model_command)
main.add_command(report_command)
main.add_command(reproduce_command)
main.add_command(scene_command)
main.add_command(workload_command)
