"""Ids and manifests of Cryptomatte (Friedman and Jones 2015, specification 1.2.0)."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable

_WORD = 0xFFFFFFFF
_C1, _C2 = 0xCC9E2D51, 0x1B873593


def murmur3(data: bytes) -> int:
    """MurmurHash3_x86_32 (Appleby, public domain) with seed 0."""
    h = 0
    whole = len(data) & ~3
    for (k,) in struct.iter_unpack("<I", data[:whole]):
        h ^= _mixed(k)
        h = (_turned(h, 13) * 5 + 0xE6546B64) & _WORD
    if data[whole:]:
        h ^= _mixed(int.from_bytes(data[whole:], "little"))
    h ^= len(data)
    h = ((h ^ (h >> 16)) * 0x85EBCA6B) & _WORD
    h = ((h ^ (h >> 13)) * 0xC2B2AE35) & _WORD
    return h ^ (h >> 16)


def _turned(x: int, bits: int) -> int:
    return ((x << bits) | (x >> (32 - bits))) & _WORD


def _mixed(k: int) -> int:
    return (_turned((k * _C1) & _WORD, 15) * _C2) & _WORD


def _bytes(name: str) -> bytes:
    """As Blender keeps it: names of old files need not be UTF-8."""
    return name.encode("utf-8", "surrogateescape")


def _text(name: str) -> str:
    return _bytes(name).decode("utf-8", "replace")


def id_bits(name: str) -> int:
    """The hash of a name, its exponent moved to where it is that of an ordinary float."""
    h = murmur3(_bytes(name))
    exponent = min(max((h >> 23) & 255, 1), 254)
    return (h & 0x807FFFFF) | exponent << 23


def id_of(name: str) -> float:
    return float(struct.unpack("<f", struct.pack("<I", id_bits(name)))[0])


def metadata(layer: str, names: Iterable[str]) -> dict[str, str]:
    """What a file says of the mattes of `layer`, whose things have these names."""
    key = "cryptomatte/" + f"{murmur3(_bytes(layer)):08x}"[:7]
    manifest = {_text(name): f"{id_bits(name):08x}" for name in dict.fromkeys(names)}
    return {
        f"{key}/name": _text(layer),
        f"{key}/hash": "MurmurHash3_32",
        f"{key}/conversion": "uint32_to_float32",
        f"{key}/manifest": json.dumps(manifest, ensure_ascii=False, separators=(",", ":")),
    }
