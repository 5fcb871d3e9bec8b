"""``python -m simmpp`` is the command ``simmpp``."""

from __future__ import annotations

from simmpp.common.interrupts import ending_on_signals


def main() -> None:
    """Run the command line; Ctrl-C ends it while it is still being imported, too."""
    with ending_on_signals():
        from simmpp.cli import main as command

        command()


if __name__ == "__main__":
    main()
