"""Where things are, for tests and for processes that they start."""

from __future__ import annotations

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
"""The top of the repository."""


def environment(user_folder: str | Path) -> dict[str, str]:
    """This process's environment for another one, which finds the tests and has a Blender user
    folder of its own.
    """
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    return os.environ | {"BLENDER_USER_RESOURCES": str(user_folder), "PYTHONPATH": path}
