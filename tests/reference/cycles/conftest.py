from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.reference.cycles.worker import Worker


@pytest.fixture(scope="session")
def worker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Worker]:
    worker = Worker(tmp_path_factory.mktemp("oracle"))
    yield worker
    worker.stop()
