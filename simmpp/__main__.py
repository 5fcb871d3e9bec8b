"""The process of a command: what it shares with a terminal, and how it ends."""

from __future__ import annotations

import logging
import sys
import warnings
from io import TextIOWrapper

from simmpp.common.errors import CacheWarning
from simmpp.common.interrupts import ending_on_signals


def main() -> None:
    """Run the command line; Ctrl-C ends it while it is still being imported, too."""
    with ending_on_signals():
        _print_what_can_be()
        if not sys.warnoptions:  # whoever asks Python for warnings gets them as Python shows them
            _tell_only_what_concerns_users()
        from simmpp.cli import main as command

        command()


def _print_what_can_be() -> None:
    """A terminal may be unable to show a character, and a file's name need not be text."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")


def _tell_only_what_concerns_users() -> None:
    """Other libraries warn those who call them, which is this package."""
    warnings.showwarning = _show
    logging.getLogger().addHandler(logging.NullHandler())  # else warnings go to the error output


def _show(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
    if issubclass(category, CacheWarning) and sys.stderr is not None:
        print(f"simmpp: {message}", file=sys.stderr)


if __name__ == "__main__":
    main()
