"""The denoiser on a graphics card. A stand-in for one, where there is none: the processor as a
device with memory of its own.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from photon_splat.core.render import denoise, oidn
from photon_splat.core.render.settings import FinalGather

from tests.support import corescene as c

NAME = "A card with memory of its own"


@pytest.fixture
def card(monkeypatch: pytest.MonkeyPatch) -> Iterator[oidn.Device]:
    device = oidn.Device(oidn.library().oidnNewDevice(oidn.CPU), NAME)
    device.commit()
    monkeypatch.setattr(denoise, "graphics_card", lambda: device)
    yield device
    device.release()


def shoot(backend: str, denoises: bool = True) -> tuple[np.ndarray, dict]:
    result = c.shoot(
        c.lit_box(64, 48),
        passes=1,
        photons_per_pass=2000,
        denoise=denoises,
        final_gather=FinalGather.OFF,
        backend=backend,
    )
    return result.passes["Combined"], result.statistics


@pytest.mark.parametrize("noisy_features", [False, True])
@pytest.mark.parametrize("quality", denoise.Quality)
@pytest.mark.parametrize("parts", [False, True])
def test_copies_to_and_fro_change_nothing(
    card: oidn.Device, noisy_features: bool, quality: denoise.Quality, parts: bool
) -> None:
    random = np.random.default_rng(1)
    images = [random.random((48, 80, 3), np.float32) for _ in range(3)]
    apart = 0.5 * images[0] if parts else None
    here, there = (
        denoise.denoise(
            *images, apart=apart, noisy_features=noisy_features, quality=quality, on_card=on_card
        )
        for on_card in (False, True)
    )
    assert not np.array_equal(here, images[0])
    assert np.allclose(here, there, atol=1e-6)


def test_the_backend_says_who_denoises(card: oidn.Device) -> None:
    noisy, _ = shoot("CPU", denoises=False)
    for backend, name in (("CPU", "CPU"), ("AUTO", NAME)):
        clean, statistics = shoot(backend)
        assert statistics["denoiser"] == name
        assert statistics["backend"] == "CPU"
        assert not np.array_equal(clean, noisy)


def test_a_card_that_fails_is_named_and_the_picture_is_denoised(
    card: oidn.Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    want, _ = shoot("CPU")
    check = oidn.Device.check

    def out_of_memory(device: oidn.Device) -> None:
        check(device)
        if device is card:
            raise oidn.DeviceFailed("Open Image Denoise failed: out of memory")

    monkeypatch.setattr(oidn.Device, "check", out_of_memory)
    got, statistics = shoot("AUTO")
    assert np.array_equal(got, want)
    assert statistics["warnings"] == [
        "The graphics card has not denoised the picture: Open Image Denoise failed: out of memory. "
        "The processor has."
    ]


def test_a_card_without_memory_leaves_the_work_to_the_processor(
    card: oidn.Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    want, _ = shoot("CPU")
    monkeypatch.setattr(oidn.library(), "oidnNewBuffer", lambda *_: None)
    got, statistics = shoot("AUTO")
    assert np.array_equal(got, want)
    (said,) = statistics["warnings"]
    assert said.startswith("The graphics card has not denoised the picture: ")
    assert said.endswith(". The processor has.")


def test_no_buffer_is_left(card: oidn.Device, monkeypatch: pytest.MonkeyPatch) -> None:
    lib, made, released = oidn.library(), [], []
    new, release = lib.oidnNewBuffer, lib.oidnReleaseBuffer
    monkeypatch.setattr(lib, "oidnNewBuffer", lambda *a: made.append(new(*a)) or made[-1])
    monkeypatch.setattr(lib, "oidnReleaseBuffer", lambda b: (released.append(b), release(b)))
    image = np.random.default_rng(1).random((32, 32, 3), np.float32)
    denoise.denoise(image, image, image, noisy_features=True, on_card=True)
    cancelled = denoise.denoise(image, image, image, on_card=True, should_cancel=lambda: True)
    assert np.array_equal(cancelled, image)
    assert len(made) > 8
    assert sorted(made) == sorted(released)


def test_no_card_is_no_error() -> None:
    """Whatever this machine has, asking is safe, and asked twice it is the same."""
    found = oidn.graphics_card()
    assert found is oidn.graphics_card()
    assert denoise.device_name(True) == (found.card if found else "CPU")
    assert denoise.device_name(False) == "CPU"
