"""What processes that are timed find around them."""

from __future__ import annotations

import os


def environment(user_folder: str) -> dict[str, str]:
    """As Blender's users have it: compiled modules are kept (a render's first export compiles for
    50 ms where a variable forbids that), with a Blender user folder of its own.
    """
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return kept | {"BLENDER_USER_RESOURCES": user_folder}
