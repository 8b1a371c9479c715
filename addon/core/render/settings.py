"""What a render is asked for, independent of Blender."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TypeVar


class Integrator(StrEnum):
    SPLAT = "splat"
    REFERENCE = "reference"


class Backend(StrEnum):
    AUTO = "AUTO"
    CPU = "CPU"
    GPU = "GPU"


class FinalGather(StrEnum):
    AUTO = "AUTO"
    ON = "ON"
    OFF = "OFF"


class IndirectLight(StrEnum):
    """What brings indirect light, as the plan has decided: photons where camera paths first meet a
    diffuse surface, or after one more bounce. OR_PATHS: a trial may find that it is less work if
    camera paths bring all of it, caustics excepted. ANY: photons or paths, and final gathering
    where a pilot finds that few photons arrive.
    """

    PHOTONS = "PHOTONS"
    PHOTONS_OR_PATHS = "PHOTONS_OR_PATHS"
    ANY = "ANY"
    FINAL_GATHER = "FINAL_GATHER"
    FINAL_GATHER_OR_PATHS = "FINAL_GATHER_OR_PATHS"


Word = TypeVar("Word", bound=StrEnum)


def _word(words: type[Word], name: str, given: str) -> Word:
    try:
        return words(given)
    except ValueError:
        raise ValueError(f"{name} is '{given}'; it must be one of {', '.join(words)}") from None


@dataclass(slots=True)
class RenderSettings:
    """Settings of one render; it stops at whichever of `passes`, `time_limit` and `error_threshold`
    comes first.

    time_limit           seconds from `started` (0 = none); passes have half of it at least, however
                         long the scene takes before them
    error_threshold      relative RMS error of the picture, as statistics["error"] estimates it (0 =
                         none); with denoise that before denoising, and a hundredth of the pixels
                         does not count
    passes               passes; in each one camera sample per pixel, more where noise is
                         (adaptive_samples)
    photons_per_pass     photon paths that start in the first pass, of caustics down to a quarter
                         where few of them end in view; with adaptive_samples off in each
    max_bounces          surface bounces between light and camera; 0 = direct light only
    radius_scale         multiplies the automatic kernel radius
    boundary_correction  divide by the kernel mass M(x) at patch boundaries
    caustics             photons of their own, aimed and with narrow kernels, for light through
                         sharp lobes; False: in with the others
    denoise              run Open Image Denoise on the finished picture
    backend              AUTO: the processor splats, and a graphics card denoises if there is one
                         that can; CPU: the processor does both; GPU: the card splats, too
    occlusion            look for things that stand inside of the discs, and for walls; part of
                         boundary_correction
    adaptive_indirect    camera paths go on for indirect light where surfaces are too small, too
                         bent or too dark for photons
    final_gather         photons light what camera paths meet after one more bounce, instead of what
                         they see first: noisier, and sharp. AUTO: where the picture is denoised,
                         else the plan makes OFF of it; and where it is less work by a trial, camera
                         paths bring all of the indirect light, caustics excepted
    adaptive_radius      radii per pixel, from how discs of two sizes have differed in earlier
                         passes
    adaptive_samples     more camera samples where lamps, edges and direct light are noisier than
                         the rest of the picture, and after the first pass a quarter to eight times
                         as many photons, as is worth their work beside that of the camera samples
    threads              0 = all of the machine
    point_spacing        gather points are this many kernel radii apart; 0 = one per camera
                         sample
    """

    passes: int = 64
    time_limit: float = 0.0
    error_threshold: float = 0.0
    photons_per_pass: int = 200_000
    max_bounces: int = 32
    radius_scale: float = 1.0
    boundary_correction: bool = True
    caustics: bool = True
    denoise: bool = False
    occlusion: bool = True
    adaptive_indirect: bool = True
    final_gather: FinalGather = FinalGather.AUTO
    adaptive_radius: bool = True
    adaptive_samples: bool = True
    backend: Backend = Backend.AUTO
    seed: int = 0
    threads: int = 0
    integrator: Integrator = Integrator.SPLAT
    point_spacing: float = 1.0 / 3.0

    @property
    def denoises_on_card(self) -> bool:
        """Whether a graphics card denoises, if there is one that can."""
        return self.backend != Backend.CPU

    def __post_init__(self) -> None:
        self.backend = _word(Backend, "backend", self.backend)
        self.final_gather = _word(FinalGather, "final_gather", self.final_gather)
        self.integrator = _word(Integrator, "integrator", self.integrator)
        if self.passes < 1:
            raise ValueError(f"passes is {self.passes}; it must be at least 1")
        if self.photons_per_pass < 0:
            raise ValueError(
                f"photons_per_pass is {self.photons_per_pass}; it must not be negative"
            )
        if self.max_bounces < 0:
            raise ValueError(f"max_bounces is {self.max_bounces}; it must not be negative")
        if not self.time_limit >= 0.0:
            raise ValueError(
                f"time_limit is {self.time_limit}; it must be 0 (none) or a number of seconds"
            )
        if not 0.0 <= self.error_threshold < float("inf"):
            raise ValueError(
                f"error_threshold is {self.error_threshold}; it must be 0 (none) or a positive "
                "number"
            )
        if not 0.0 < self.radius_scale < float("inf"):
            raise ValueError(f"radius_scale is {self.radius_scale}; it must be positive")
        if self.threads < 0:
            raise ValueError(
                f"threads is {self.threads}; it must be 0 (all) or a number of threads"
            )
