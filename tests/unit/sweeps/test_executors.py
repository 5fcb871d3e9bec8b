"""Who runs the tasks: the address of a cluster is tried before a client of it is made."""

import pytest

from simmpp.common.errors import ConfigError
from simmpp.sweeps.executors import pool_for
from simmpp.sweeps.worker import run_task


@pytest.mark.parametrize("address", ["foo", "tcp://127.0.0.1:9", "nonsense://x", ""])
def test_no_client_is_made_for_no_cluster(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("distributed")
    made: list[object] = []
    monkeypatch.setattr("simmpp.sweeps.executors.CONNECT_S", 1)
    monkeypatch.setattr(distributed, "Client", lambda *address, **options: made.append(address))
    with pytest.raises(ConfigError, match="--cluster: value "):
        pool_for(1, address, run_task)
    assert not made
