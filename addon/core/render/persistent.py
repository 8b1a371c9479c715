"""What a final render leaves for the next: the native renderer with acceleration structure, lights
and photons. Knows no Blender.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..native.camera import place_camera
from ..native.fill import fill_renderer, replace_shading
from ..native.instances import find_flat
from ..native.library import load
from ..native.options import set_options
from ..scene import Scene, same_geometry, same_shading
from .plan import make_plan
from .settings import RenderSettings

if TYPE_CHECKING:
    from photon_splat_native import Renderer

MOST_PHOTON_BYTES = 1 << 30
"""Of photons that are kept; passes whose photons do not fit trace them again in every render."""
OF_ONE_RENDER = ("passes", "time_limit", "error_threshold", "denoise", "backend")
"""Settings that the renderer does not know."""


@dataclass(frozen=True, slots=True)
class Start:
    """A renderer that renders once `prepare` has been called, on any thread. reused: its geometry
    is that of an earlier render.
    """

    renderer: Renderer
    prepare: Callable[[], None]
    reused: bool = False


def start_anew(scene: Scene, settings: RenderSettings, kept_photon_bytes: int = 0) -> Start:
    """A new renderer that holds all of `scene`. Errors: those of fill_renderer."""
    renderer = load().Renderer(settings.threads)
    plan = make_plan(scene, settings)
    fill_renderer(renderer, scene, plan.applied_to(settings), plan)
    renderer.options.kept_photon_bytes = kept_photon_bytes
    return Start(renderer, renderer.build)


class Persistent:
    """Keeps the renderer of the last render. A render calls start(), and keep() when it has ended
    without an error.

    Photons of a pass are the same in all renders of a scene, whatever the camera sees, so that
    nothing flickers.
    """

    def __init__(self, most_photon_bytes: int = MOST_PHOTON_BYTES) -> None:
        self._most = most_photon_bytes
        self._left: tuple[Scene, RenderSettings, Renderer] | None = None

    def start(self, scene: Scene, settings: RenderSettings) -> Start:
        """A renderer for `scene`: the last one, as far as it fits. Errors: those of fill_renderer;
        nothing is kept then.
        """
        left, self._left = self._left, None
        if (
            left is None
            or not same_geometry(left[0], scene)
            or _known(left[0], left[1]) != _known(scene, settings)
        ):
            del left  # before the new one takes memory
            return start_anew(scene, settings, self._most)
        known, _, renderer = left
        relit, plan = not same_shading(known, scene), make_plan(scene, settings)

        def prepare() -> None:
            place_camera(renderer, scene.camera, scene.frame)
            set_options(renderer, plan.applied_to(settings), plan)
            renderer.begin_again()
            if relit:
                replace_shading(renderer, scene)

        find_flat(scene)
        renderer.resume()
        return Start(renderer, prepare, reused=True)

    def keep(self, scene: Scene, settings: RenderSettings, renderer: Renderer) -> None:
        """`renderer` has been prepared for this; nothing of it runs."""
        self._left = (scene, settings, renderer)

    def clear(self) -> None:
        self._left = None

    @property
    def empty(self) -> bool:
        return self._left is None


def _known(scene: Scene, settings: RenderSettings) -> RenderSettings:
    """What the renderer has been told of the settings."""
    applied = make_plan(scene, settings).applied_to(settings)
    defaults = RenderSettings()
    return replace(applied, **{name: getattr(defaults, name) for name in OF_ONE_RENDER})
