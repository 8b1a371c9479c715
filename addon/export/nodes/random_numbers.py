"""Random numbers that belong to things, as Blender has them."""

from __future__ import annotations


def name_random(name: str) -> float:
    """Of an object, by its name."""
    value = 0
    for byte in name.encode():
        value = (value * 37 + byte) & 0xFFFFFFFF
    return number_random(value)


def number_random(value: int, words: int = 2) -> float:
    """Bob Jenkins' lookup3 (public domain) of (value, 0), or of value alone, scaled to 0..1."""

    def turn(x: int, k: int) -> int:
        return ((x << k) | (x >> (32 - k))) & 0xFFFFFFFF

    start = (0xDEADBEEF + (words << 2) + 13) & 0xFFFFFFFF
    a, b, c = (start + value) & 0xFFFFFFFF, start, start
    c = ((c ^ b) - turn(b, 14)) & 0xFFFFFFFF
    a = ((a ^ c) - turn(c, 11)) & 0xFFFFFFFF
    b = ((b ^ a) - turn(a, 25)) & 0xFFFFFFFF
    c = ((c ^ b) - turn(b, 16)) & 0xFFFFFFFF
    a = ((a ^ c) - turn(c, 4)) & 0xFFFFFFFF
    b = ((b ^ a) - turn(a, 14)) & 0xFFFFFFFF
    c = ((c ^ b) - turn(b, 24)) & 0xFFFFFFFF
    return c / 0xFFFFFFFF
