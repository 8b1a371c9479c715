"""How large a pass may be: what of it can be done before the time limit."""

from __future__ import annotations

from typing import NamedTuple

FEWEST_PHOTONS = 0.25
"""Least share of the photons that a pass wants. Where time is short, a pass gets so many before any
pixel gets a second sample, or is left out.
"""


class PassSize(NamedTuple):
    """The size of a pass, or the seconds for it: camera samples per pixel, and photons relative to
    those of the first pass.
    """

    samples: float
    photons: float


def pass_that_fits(
    left: float, took: float, seconds: PassSize, last: PassSize, wanted: PassSize
) -> PassSize | None:
    """What of the pass `wanted` can be done in `left` seconds, if the last one took `took`,
    `seconds` of them for its samples and photons: one sample of each pixel, and the same part of
    all others and of photons, but not too few photons; None if there is no time for that.
    """
    left -= took - sum(seconds)
    of_one = seconds.samples / last.samples  # in each pixel
    of_others = of_one * (wanted.samples - 1.0)
    of_photons = seconds.photons * wanted.photons / last.photons
    if left < of_one + FEWEST_PHOTONS * of_photons:
        return None
    if of_one + of_others + of_photons <= left:
        return wanted
    share = (left - of_one) / (of_others + of_photons)
    if share >= FEWEST_PHOTONS:
        return PassSize(1.0 + share * (wanted.samples - 1.0), share * wanted.photons)
    of_fewest = FEWEST_PHOTONS * of_photons
    share = (left - of_one - of_fewest) / of_others if of_others > 0.0 else 0.0
    return PassSize(1.0 + share * (wanted.samples - 1.0), FEWEST_PHOTONS * wanted.photons)
