"""What all tests of commands begin with."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from calls import begin_in, simmpp


@pytest.fixture(scope="session", autouse=True)
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Tracer and engine have been used before: no command says that it compiles."""
    folder = tmp_path_factory.mktemp("first")
    with pytest.MonkeyPatch.context() as patch:
        begin_in(folder, patch)
        Path("c.yaml").write_text("{scene: tetra:2, picture: {resolution: 12}, processors: 4}")
        assert simmpp("run", "c.yaml").exit_code == 0
    yield
