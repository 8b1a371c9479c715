"""Open Image Denoise, as Blender ships it, by its C interface.

The library is looked up by its name: inside Blender, and after `import bpy`, it is in the process
or beside Blender's other libraries. Nothing is bundled.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..native.blender_libraries import DENOISER, places

DEVICE_CPU = 1
FLOAT3 = 3
QUALITY_FAST, QUALITY_BALANCED = 4, 5
LUMINANCE = (0.2126, 0.7152, 0.0722)
WINDOW = 2
"""Half the side, in pixels, of the square over which noise and blur are averaged."""
MEDIUM_GREY = 0.18
CAUTION = 8.0
DOUBT = 2.0
"""Factor on the estimated variance, which may be half of the true one: an estimate that is too low
would take noise for blur and mix it back in.
"""

_MONITOR = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_double)


class DenoiserMissing(Exception):
    """There is no Open Image Denoise here; the message says what was looked for."""


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL:
    for name in (DENOISER, *map(str, places(DENOISER))):
        try:
            library = ctypes.CDLL(name)
        except OSError:
            continue
        handle = ctypes.c_void_p
        for function, result, arguments in (
            ("oidnNewDevice", handle, [ctypes.c_int]),
            ("oidnCommitDevice", None, [handle]),
            ("oidnReleaseDevice", None, [handle]),
            ("oidnSetDeviceInt", None, [handle, ctypes.c_char_p, ctypes.c_int]),
            ("oidnSetDeviceBool", None, [handle, ctypes.c_char_p, ctypes.c_bool]),
            ("oidnGetDeviceError", ctypes.c_int, [handle, ctypes.POINTER(ctypes.c_char_p)]),
            ("oidnNewFilter", handle, [handle, ctypes.c_char_p]),
            ("oidnReleaseFilter", None, [handle]),
            (
                "oidnSetSharedFilterImage",
                None,
                [handle, ctypes.c_char_p, handle, ctypes.c_int] + [ctypes.c_size_t] * 5,
            ),
            ("oidnSetFilterBool", None, [handle, ctypes.c_char_p, ctypes.c_bool]),
            ("oidnSetFilterInt", None, [handle, ctypes.c_char_p, ctypes.c_int]),
            ("oidnSetFilterFloat", None, [handle, ctypes.c_char_p, ctypes.c_float]),
            ("oidnSetFilterProgressMonitorFunction", None, [handle, _MONITOR, handle]),
            ("oidnCommitFilter", None, [handle]),
            ("oidnExecuteFilter", None, [handle]),
        ):
            entry = getattr(library, function)
            entry.restype, entry.argtypes = result, arguments
        return library
    raise DenoiserMissing(
        f"the denoiser needs {DENOISER}, which Blender ships and which has not been found here"
    )


def available() -> bool:
    try:
        _library()
    except DenoiserMissing:
        return False
    return True


def blend(
    noisy: NDArray[np.float32],
    denoised: NDArray[np.float32],
    variance: NDArray[np.float32],
    passes: int,
) -> NDArray[np.float32]:
    """The mixture of both pictures (height, width, 3) of the least expected squared error: a
    denoiser blurs what it takes for noise, and what it blurs stays wrong however long one renders.
    Where the two differ by more than the noise of the one explains, (noisy - denoised)^2 = variance
    + blur^2 (as in Stein's estimate), the noisy one has the share blur^2 / (blur^2 + variance).

    A pixel that differs alone, without two like it around it, is a speck of noise: it gets nothing,
    and tells nothing of the blur around it.

    variance: of the noisy picture's luminance, (height, width), as estimated after `passes` passes;
    few passes are trusted less.
    """
    difference = (noisy - denoised) @ np.asarray(LUMINANCE, np.float32)
    square = difference**2
    alone = _alone(square)
    known = np.maximum(_window_mean((~alone).astype(np.float32)), 1e-6)
    square, noise = (
        _window_mean(np.where(alone, 0.0, square)) / known,
        _window_mean(np.where(alone, 0.0, variance)) / known * DOUBT * (1.0 + CAUTION / passes),
    )
    blur = np.maximum(square - noise, 0.0)
    share = np.divide(blur, blur + noise, out=np.zeros_like(blur), where=(blur > 0) & ~alone)
    share = share[..., None]
    return denoised + share * (noisy - denoised)


def _alone(square: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Whether a pixel differs by itself: fewer than two of its neighbours have a tenth of its
    squared difference.
    """
    height, width = square.shape
    around = np.pad(square, 1, mode="edge")
    alike = sum(
        (around[y : y + height, x : x + width] > 0.1 * square).astype(np.int8)
        for y in range(3)
        for x in range(3)
        if (y, x) != (1, 1)
    )
    return np.asarray(alike < 2)


def _window_mean(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Mean over (2 WINDOW + 1)^2 pixels; pixels at the border are repeated outwards."""
    size = 2 * WINDOW + 1
    padded = np.pad(
        values.astype(np.float64), ((WINDOW + 1, WINDOW), (WINDOW + 1, WINDOW)), mode="edge"
    )
    padded[0, :] = padded[:, 0] = 0.0
    sums = padded.cumsum(0).cumsum(1)
    boxes = sums[size:, size:] - sums[:-size, size:] - sums[size:, :-size] + sums[:-size, :-size]
    return np.asarray(np.maximum(boxes, 0.0) / size**2, np.float32)


def denoise(
    color: NDArray[np.float32],
    albedo: NDArray[np.float32],
    normal: NDArray[np.float32],
    *,
    apart: NDArray[np.float32] | None = None,
    noisy_features: bool = False,
    fast: bool = False,
    threads: int = 0,
    should_cancel: Callable[[], bool] | None = None,
) -> NDArray[np.float32]:
    """Returns `color` (height, width, 3), linear, without its noise; the features have its shape.

    apart: a part of `color` with noise and edges of its own, such as direct light. It and the rest
    are denoised separately.

    noisy_features: albedo and normal come from few samples and are denoised first, or their own
    noise would show in the picture.

    fast: a quarter of the time, or with noisy features, which then count less, an eighth; for a
    picture that a better one follows.

    threads: 0 = all. A cancelled run returns `color` unchanged. Raises DenoiserMissing, or
    RuntimeError with the library's message.
    """
    library = _library()
    color, albedo, normal = (
        np.ascontiguousarray(a, np.float32) for a in (color, np.clip(albedo, 0.0, 1.0), normal)
    )
    device = library.oidnNewDevice(DEVICE_CPU)
    if not device:
        raise RuntimeError("Open Image Denoise could not be started")
    try:
        if threads:
            library.oidnSetDeviceInt(device, b"numThreads", threads)
        library.oidnSetDeviceBool(device, b"setAffinity", False)
        library.oidnCommitDevice(device)
        run = _Run(library, device, should_cancel, fast)
        if noisy_features and not fast:
            albedo, normal = (
                run.filter({name: image}, prefilter=True)
                for name, image in ((b"albedo", albedo), (b"normal", normal))
            )
        parts, exposure = [color], None
        if apart is not None:
            apart = np.ascontiguousarray(apart, np.float32)
            parts, exposure = [apart, np.maximum(color - apart, 0.0)], _exposure(color)
        filtered = [
            run.filter(
                {b"color": part, b"albedo": albedo, b"normal": normal},
                clean_features=not (noisy_features and fast),
                exposure=exposure,
            )
            for part in parts
        ]
        message = ctypes.c_char_p()
        if library.oidnGetDeviceError(device, ctypes.byref(message)) and not run.cancelled:
            raise RuntimeError(
                f"Open Image Denoise failed: {(message.value or b'unknown error').decode()}"
            )
    finally:
        library.oidnReleaseDevice(device)
    return color if run.cancelled else np.sum(filtered, axis=0, dtype=np.float32)


def _exposure(color: NDArray[np.float32]) -> float:
    """The factor that brings the picture's mean luminance to a medium grey. All parts of a picture
    share it: a part that is mostly black, as direct light may be, would otherwise be brightened
    until its highlights clip. A pixel counts up to 64 times the geometric mean.
    """
    light = np.maximum(color @ np.asarray(LUMINANCE, np.float32), 1e-8)
    mean = float(np.minimum(light, 64.0 * np.exp(np.log(light).mean())).mean())
    return MEDIUM_GREY / mean


class _Run:
    """Runs filters on one device; after a cancelled filter no other one runs."""

    def __init__(
        self,
        library: ctypes.CDLL,
        device: int,
        should_cancel: Callable[[], bool] | None,
        fast: bool,
    ) -> None:
        self.library, self.device = library, device
        self.should_cancel = should_cancel
        self.fast = fast
        self.cancelled = False

    def _monitor(self, _: int | None, __: float) -> bool:
        self.cancelled = self.cancelled or (self.should_cancel is not None and self.should_cancel())
        return not self.cancelled

    def filter(
        self,
        images: dict[bytes, NDArray[np.float32]],
        *,
        prefilter: bool = False,
        clean_features: bool = True,
        exposure: float | None = None,
    ) -> NDArray[np.float32]:
        """Returns the first image without its noise; the others are its features. prefilter: the
        image is a feature itself. clean_features: they have no noise. exposure: the factor that
        the denoiser multiplies the image by (None: it chooses).
        """
        first = next(iter(images.values()))
        if self.cancelled:
            return first
        output = np.empty_like(first)
        monitor = _MONITOR(self._monitor)
        height, width = first.shape[:2]
        handle = self.library.oidnNewFilter(self.device, b"RT")
        try:
            for name, image in (*images.items(), (b"output", output)):
                self.library.oidnSetSharedFilterImage(
                    handle, name, image.ctypes.data, FLOAT3, width, height, 0, 0, 0
                )
            if self.fast or prefilter:
                quality = QUALITY_FAST if self.fast else QUALITY_BALANCED
                self.library.oidnSetFilterInt(handle, b"quality", quality)
            if not prefilter:
                self.library.oidnSetFilterBool(handle, b"hdr", True)
                self.library.oidnSetFilterBool(handle, b"cleanAux", clean_features)
                if exposure is not None:
                    self.library.oidnSetFilterFloat(handle, b"inputScale", exposure)
            self.library.oidnSetFilterProgressMonitorFunction(handle, monitor, None)
            self.library.oidnCommitFilter(handle)
            self.library.oidnExecuteFilter(handle)
        finally:
            self.library.oidnReleaseFilter(handle)
        return output
