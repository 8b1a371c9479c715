"""Tests that need an OpenGL context ask for the fixture `opengl`."""

from __future__ import annotations

import pytest

from tests.support.opengl import need_opengl


@pytest.fixture(scope="session")
def opengl() -> None:
    need_opengl()
