"""A short name of what a scene holds, the same on every machine that reads it alike."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np

from ..scene import Scene

UNTOLD = ("warnings", "missing")
"""What of a scene is no part of it."""


def fingerprint(scene: Scene) -> str:
    """32 hexadecimal digits of BLAKE2b over everything that is rendered."""
    digest = hashlib.blake2b(digest_size=16)
    for entry in fields(scene):
        if entry.name not in UNTOLD:
            for piece in _pieces(getattr(scene, entry.name)):
                digest.update(piece)
    return digest.hexdigest()


def _pieces(value: Any) -> Iterable[bytes | memoryview]:
    """`value` as bytes; every piece says where it ends."""
    if isinstance(value, np.ndarray):
        yield f"{value.dtype.str}{value.shape}".encode()
        if value.size:
            yield memoryview(np.ascontiguousarray(value).reshape(-1).view(np.uint8))
    elif isinstance(value, Enum):
        yield f"{type(value).__name__}.{value.name};".encode()
    elif is_dataclass(value):
        yield f"{type(value).__name__}(".encode()
        for entry in fields(value):
            yield from _pieces(getattr(value, entry.name))
    elif isinstance(value, list | tuple):
        yield f"[{len(value)}".encode()
        for one in value:
            yield from _pieces(one)
    elif isinstance(value, dict):
        yield f"{{{len(value)}".encode()
        for key, one in value.items():
            yield from _pieces(key)
            yield from _pieces(one)
    elif isinstance(value, bytes):
        yield f"b{len(value)}:".encode()
        yield value
    else:
        text = repr(value).encode("utf-8", "surrogatepass")
        yield f"{len(text)}:".encode()
        yield text
