"""Finds the GLSL files: inside the package where it is installed, beside it in a checkout."""

from __future__ import annotations

import re
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2]
FOLDERS = (PACKAGE / "shaders", PACKAGE.parent / "shaders")


def source(name: str, version: int) -> str:
    """A shader for GLSL `version`, with what it includes. FileNotFoundError where the installation
    lacks it.
    """
    return f"#version {version}\n" + re.sub(
        r'^#include "(.+)"$', lambda found: _text(found[1]), _text(name), flags=re.MULTILINE
    )


def _text(name: str) -> str:
    for folder in FOLDERS:
        if (folder / name).is_file():
            return (folder / name).read_text(encoding="utf-8")
    raise FileNotFoundError(f"this installation of Photon Splat lacks the shader {name}")
