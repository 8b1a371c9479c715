"""What a render says of itself: RenderResult.statistics, which --stats writes as JSON.

Counts are of the whole render. Of a render that finds its photons again (Persistent Data) they
count what this render has done.
"""

# No postponed annotations: a TypedDict finds out by them which of its keys must be there.

from typing import NotRequired, TypedDict


class Seconds(TypedDict):
    """Wall time, s, of the phases; of those on a graphics card what the CPU takes for them."""

    export: float
    """Blender's data to plain arrays; 0 for a scene that came as arrays."""
    acceleration: float
    """Embree's tree and the tables of the lights."""
    camera: float
    """Camera paths, direct light, and final gathering."""
    photons: float
    """Tracing photons, their pilot among them."""
    splat: float
    """Adding photons to gather points."""
    boundary: float
    """How much of the discs lies off their surfaces or behind something."""
    error: float
    """Estimating the error."""
    denoise: NotRequired[float]
    """With denoising only."""
    total: float
    """From the call to the result, export included."""


class MapCounts(TypedDict):
    """Of one photon map."""

    traced: int
    """Paths from lights."""
    stored: int
    """Hits that may light a gather point."""
    guided: bool
    """Whether emission is guided to where photons end in view."""


class Beams(TypedDict):
    """Photons on their way through media, of caustic light; not in the sums of photons."""

    traced: int
    """Paths."""
    stored: int
    """Ways."""


class Photons(TypedDict):
    indirect: NotRequired[MapCounts]
    caustic: NotRequired[MapCounts]
    """Each where the scene has such a photon map; both are in the sums below."""
    beams: Beams
    traced: int
    stored: int
    pilot: int
    """Paths that only told how to aim; not in `traced`."""
    reused: int
    """Paths of an earlier render's photons."""
    kept_bytes: int
    """Of photons that stay in memory for the next render."""


class Error(TypedDict):
    """Estimates for Combined, RMS over the pixels, relative to its mean luminance where nothing
    else is said.
    """

    relative_rmse: float
    """Of noise and bias together: what error_threshold is compared with if nothing is denoised."""
    standard_error: float
    """Noise alone."""
    bias: float
    """Blur by the kernel."""
    denoised: NotRequired[float]
    """Of a denoised picture, about, relative to each pixel's own luminance: what error_threshold is
    compared with then.
    """


class Discs(TypedDict):
    """Kernels of gather points."""

    points: int
    obstructed: int
    """Those that something stands in."""
    measured: int
    """Those whose kernel mass was found: photons have reached them, or it decides their size."""
    cut: int
    """Of these, those that a surface's edge cuts."""


class PathTraced(TypedDict):
    """Gather points whose indirect light comes by paths from the camera."""

    points: int
    share: float
    """Of all gather points, 0..1."""
    everywhere: bool
    """The scene is such that paths cost less than photons; caustics excepted."""
    gathers_after_all: bool
    """They take one more bounce before photons light them, though final gathering is not asked for:
    few photons end in view."""
    world: bool
    """They bring all of the world's light: it asks how often rays have bounced."""


class Reused(TypedDict):
    """From the render before, with Persistent Data."""

    geometry: bool
    photons: int


class PlanSummary(TypedDict):
    sentences: list[str]
    """For the user: what the scene lacks, and what the render has found."""
    flags: dict[str, bool]
    """Whether a part of the renderer ran, by its name."""


class Gpu(TypedDict):
    """Of the splatter on a graphics card."""

    renderer: str
    """The card, as OpenGL names it."""
    busy_seconds: float
    """Drawing, copies to and fro included."""
    card_seconds: float
    """Of that, copies to the card and drawing by the card's own clock."""
    cpu_busy_seconds: float
    """Tracing photons and pairing them with blocks of gather points."""
    wall_seconds: float
    """Of both together."""
    pairs: int
    """Of a photon and a block of gather points."""
    batches: int
    atlases: int
    """Textures that the gather points of the last pass filled."""


class Statistics(TypedDict):
    seconds: Seconds
    photons: Photons
    rays: int
    """All that were traced, shadow rays included."""
    threads: int
    threads_wanted: int
    """More than `threads` where the system refused some."""
    kernel: str
    """The instruction set that splats: sse2, avx2, avx512, ..."""
    visible_points: int
    """Gather points of the last pass."""
    bad_samples: int
    """Camera samples that were not finite, and left out."""
    error: Error
    discs: Discs
    path_traced: PathTraced
    passes: int
    backend: str
    """CPU or GPU: what splatted the photons."""
    integrator: str
    cancelled: bool
    film_bytes: int
    texture_bytes: int
    reused: Reused
    peak_memory_bytes: int
    """Of the whole process, Blender included."""
    warnings: list[str]
    plan: PlanSummary
    denoiser: NotRequired[str]
    """What denoises: the graphics card's name, or CPU; empty where there is no denoiser."""
    gpu: NotRequired[Gpu]
    """Where a graphics card splatted."""
    startup_seconds: NotRequired[float]
    """Command line: from its start to the begin of the render."""
    version: NotRequired[str]
    """Command line: of the engine."""
