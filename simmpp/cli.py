"""The command line: a table of commands, imported when they are needed; mistakes are one line."""

from __future__ import annotations

import os
import sys
from difflib import get_close_matches
from importlib import import_module
from typing import Any, NoReturn

import click

from simmpp.common.errors import InputError, ModelError
from simmpp.common.interrupts import last_word
from simmpp.common.modules import COMPLETION

COMMANDS = {
    "init": "Write a configuration to begin with, each key explained.",
    "run": "Compare dataflow policies at one point.",
    "sweep": "Simulate every combination of the values under the key sweep.",
    "report": "Make a page of what sweep, run, bench or reproduce wrote.",
    "advise": "Say which policy to use on how many nodes.",
    "compare": "Compare the rows of two folders, point by point.",
    "check": "Compare a sweep with its baseline; exit with 1 if it moved.",
    "model": "Say which dataflow the paper's analytical model expects to win.",
    "bench": "Measure the run time of each method against its error.",
    "reproduce": "Repeat the experiments of Nebel 1998 and judge its claims.",
    "policy": "Write a policy of your own, and check it.",
    "scene": "List the objects and materials of a scene.",
    "workload": "List the rays of a picture, and which objects they need.",
    "machine": "Print every constant of a machine with its source.",
    "reading": "Print all that a reading sets with its source.",
    "keys": "Print what can be set in a configuration, or all about one KEY.",
}
"""The commands in the order of work, with the first line of their help.

``run`` is ``run_command`` of simmpp.commands.run, and so on.
"""

INPUT_ERROR, MODEL_ERROR, READER_GONE = 2, 70, 141
"""Exit codes: a wrong input, a bug (EX_SOFTWARE of BSD's sysexits), a pipe that nobody reads any
more, as with ``| head`` (128 + SIGPIPE). Ctrl-C gives 130, SIGTERM 143."""


class Commands(click.Group):
    """The group of commands; whatever simmpp raises on purpose ends it without a traceback.

    A command's module, and numba with it, is imported when the command is run or asked for help.
    """

    def make_context(
        self,
        info_name: str | None,
        args: list[str],
        parent: click.Context | None = None,
        **extra: Any,
    ) -> click.Context:
        """Keep the words of the call, for those who will be told how to go on."""
        return super().make_context(info_name, args, parent, obj=("simmpp", *args), **extra)

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names in the order of work, not of the alphabet."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import the command; None if there is none so called."""
        if cmd_name not in COMMANDS:
            return None
        if ctx.resilient_parsing:  # a shell completes words
            from simmpp.commands.parts.completion import command as with_words

            return with_words(cmd_name)
        module = import_module(f"simmpp.commands.{cmd_name}")
        command: click.Command = getattr(module, f"{cmd_name}_command")
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command; one that there is not is told with the nearest that there is."""
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            if near := get_close_matches(args[0], COMMANDS, n=1):
                raise click.UsageError(f"{error.message} Did you mean {near[0]!r}?", ctx) from None
            raise

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands from the table alone: click would import each for its help."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command named."""
        try:
            return super().invoke(ctx)
        except InputError as error:
            _quit(f"error: {error}", INPUT_ERROR)
        except click.MissingParameter:
            raise  # a wrong call, not a wrong value: click shows how to call
        except click.BadParameter as error:
            _quit(f"error: {_named(error.param)}: {error.message.rstrip('.')}", INPUT_ERROR)
        except BrokenPipeError:
            _leave_pipe()
        except OSError as error:
            _quit(f"error: {error.filename or 'output'}: {error.strerror or error}", INPUT_ERROR)
        except ModelError as error:
            _quit(f"this is a bug, please report it: {error}", MODEL_ERROR)
        except KeyboardInterrupt as interrupt:
            _quit(*last_word(interrupt))
        except MemoryError:
            _quit("error: out of memory: expected a smaller scene or resolution", INPUT_ERROR)


def _leave_pipe() -> NoReturn:
    """End; what Python still holds for the pipe goes nowhere, or it would complain of that too."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in filter(None, (sys.stdout, sys.stderr)):
        os.dup2(nowhere, stream.fileno())
    sys.exit(READER_GONE)


def _named(param: click.Parameter | None) -> str:
    """The option or argument as the user knows it."""
    if isinstance(param, click.Option):
        return param.opts[0]
    return param.human_readable_name if param else "argument"


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


if "_SIMMPP_COMPLETE" in os.environ:  # set by the shell when words are to be completed
    import_module(COMPLETION)
