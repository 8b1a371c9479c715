"""One Blender for all tests of this folder, and the scenes that they render."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.integration.farm import scenes as made
from tests.support.blender import Blender


@pytest.fixture(scope="session")
def blender(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Blender]:
    one = Blender(tmp_path_factory.mktemp("blender"))
    yield one
    one.stop()


@pytest.fixture(scope="session")
def scenes(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the .blend files."""
    folder = tmp_path_factory.mktemp("scenes")
    blender.call(made.save, {"folder": str(folder)})
    return folder
