"""The notebook runs from top to bottom, and shows what it is kept with."""

from __future__ import annotations

import re
import runpy
from pathlib import Path
from typing import Any

import nbformat
import pytest

NOTEBOOKS = Path(__file__).parents[2] / "experiments" / "notebook"
PICTURE = re.compile(r"base64,[^\"]*")
"""Its bytes are those of a version of matplotlib."""


def shown(notebook: Any) -> list[tuple[str, dict[str, str]]]:
    """What each cell prints and shows, by kind; only that there is a picture is told of it."""
    outputs = []
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            data = {"stream": output.text} if "text" in output else dict(output.data)
            if "image/png" in data:
                data["image/png"] = ""
            outputs.append((cell.id, {kind: PICTURE.sub("", data[kind]) for kind in sorted(data)}))
    return outputs


def test_it_shows_what_it_is_kept_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(tmp_path))
    names = runpy.run_path(str(NOTEBOOKS / "execute.py"), run_name="read")
    kept = shown(nbformat.read(names["NOTEBOOK"], as_version=4))
    assert shown(names["executed"]()) == kept
    assert [cell for cell, _ in kept] == [
        "trace",
        "simulate",
        "concurrent",
        "ray",
        "points",
        "best",
    ]
    assert "image/png" in dict(kept)["ray"] and "<img" in dict(kept)["points"]["text/html"]
