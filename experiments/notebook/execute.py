"""Runs the notebook from nothing and keeps what it shows: python experiments/notebook/execute.py"""

from __future__ import annotations

from pathlib import Path

import nbformat
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).with_name("policies.ipynb")


def executed(notebook: Path = NOTEBOOK) -> nbformat.NotebookNode:
    """The notebook with its outputs, and without the times at which its cells ran."""
    return NotebookClient(nbformat.read(notebook, as_version=4), record_timing=False).execute()


def main() -> None:
    nbformat.write(executed(), NOTEBOOK)


if __name__ == "__main__":
    main()
