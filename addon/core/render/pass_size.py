"""How large a pass may be: what of it can be done before the time limit."""

from __future__ import annotations

from typing import NamedTuple

FEWEST_PHOTONS = 0.25
"""Least share of the photons that a pass wants. Where time is short, a pass gets so many before any
pixel gets a second sample, or is left out.
"""
FEWEST_PIXELS = 0.1
"""Least share of the pixels that a last pass has samples of."""


class PassSize(NamedTuple):
    """The size of a pass, or the seconds for it: camera samples per pixel, and photons relative to
    those of the first pass.
    """

    samples: float
    photons: float


def pass_that_fits(
    left: float,
    took: float,
    seconds: PassSize,
    last: PassSize,
    wanted: PassSize,
    *,
    may_lack_pixels: bool = False,
) -> PassSize | None:
    """What of the pass `wanted` can be done in `left` seconds, if the last one took `took`,
    `seconds` of them for its samples and photons: one sample of each pixel, and the same part of
    all others and of photons, but not too few photons; None if there is no time for that.
    may_lack_pixels: a last pass may have less than one sample a pixel.
    """
    left -= took - sum(seconds)
    of_one = seconds.samples / last.samples  # in each pixel
    of_others = of_one * (wanted.samples - 1.0)
    of_photons = seconds.photons * wanted.photons / last.photons
    of_fewest = FEWEST_PHOTONS * of_photons
    if left < of_one + of_fewest:
        share = (left - of_fewest) / of_one if of_one > 0.0 else 0.0
        if not may_lack_pixels or share < FEWEST_PIXELS:
            return None
        return PassSize(share, FEWEST_PHOTONS * wanted.photons)
    if of_one + of_others + of_photons <= left:
        return wanted
    share = (left - of_one) / (of_others + of_photons)
    if share >= FEWEST_PHOTONS:
        return PassSize(1.0 + share * (wanted.samples - 1.0), share * wanted.photons)
    share = (left - of_one - of_fewest) / of_others if of_others > 0.0 else 0.0
    return PassSize(1.0 + share * (wanted.samples - 1.0), FEWEST_PHOTONS * wanted.photons)
