"""What tests.benchmarks.bench.gpu measures of the denoiser: on the processor and on the card."""

from __future__ import annotations

import time
from collections.abc import Iterator
from statistics import median
from typing import Any

import numpy as np
from photon_splat.core.render.denoise import Quality, denoise
from photon_splat.core.render.oidn import DenoiserMissing, graphics_card

REPEATS = 5


def denoisers(quick: bool) -> Iterator[dict[str, Any]]:
    """ms of one denoised picture, median after a first one, whose ms hold what the library does
    once. viewport_ms: in the viewport's quality.
    """
    sizes = ((64, 48),) if quick else ((640, 360), (1920, 1080), (3840, 2160))
    began = time.monotonic()
    try:
        card = graphics_card()
    except DenoiserMissing as reason:
        yield {"device": str(reason)}
        return
    found = time.monotonic() - began
    for width, height in sizes:
        random = np.random.default_rng(1)
        images = [random.random((height, width, 3), np.float32) for _ in range(3)]
        for on_card in (False, True) if card else (False,):
            taken, fast = [], []
            for _ in range(REPEATS + 1):
                for times, quality in ((taken, Quality.BEST), (fast, Quality.FAST)):
                    began = time.monotonic()
                    denoise(
                        *images,
                        apart=0.5 * images[0] if quality else None,
                        noisy_features=True,
                        quality=quality,
                        on_card=on_card,
                    )
                    times.append(time.monotonic() - began)
            yield {
                "device": card.card if card and on_card else "CPU",
                "width": width,
                "height": height,
                "ms": 1e3 * median(taken[1:]),
                "viewport_ms": 1e3 * median(fast[1:]),
                "first_ms": 1e3 * taken[0],
                "found_card_ms": 1e3 * found,
            }
