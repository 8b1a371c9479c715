"""What errors are measured by."""

from __future__ import annotations

import numpy as np

from tests.support.compare import rel_mse


def test_a_noisy_reference_adds_no_error() -> None:
    """The truth is a ramp; the halves have noise half as strong as it is."""
    random = np.random.default_rng(1)
    truth = np.linspace(0.5, 1.5, 400)[:, None, None] * np.ones((400, 400, 3))
    halves = [truth * (1 + 0.5 * random.standard_normal(truth.shape)) for _ in range(2)]
    picture = 1.1 * truth
    assert abs(rel_mse(picture, *halves, 1e-4, window=7) - 0.01) < 0.002
    # a pixel's own noise in the denominator as well
    assert rel_mse(picture, *halves, 1e-4) > 0.05
