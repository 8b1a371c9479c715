"""Finds the GLSL files: inside the package where it is installed, beside it in a checkout."""

from __future__ import annotations

from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2]
FOLDERS = (PACKAGE / "shaders", PACKAGE.parent / "shaders")


def source(name: str) -> str:
    """The text of a shader. FileNotFoundError where the installation lacks it."""
    for folder in FOLDERS:
        if (folder / name).is_file():
            return (folder / name).read_text(encoding="utf-8")
    raise FileNotFoundError(f"this installation of Photon Splat lacks the shader {name}")
