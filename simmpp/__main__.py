"""``python -m simmpp`` is the command ``simmpp``."""

from simmpp.cli import main

main()
