"""Draws a picture into the region of a viewport, through Blender's own graphics module alone."""

from __future__ import annotations

from typing import Any

from ...core.viewport.view import Picture


class Canvas:
    """Draws pictures, and keeps the texture of the latest one on the graphics card."""

    def __init__(self) -> None:
        self._texture: Any = None
        self.number = 0

    def draw(self, picture: Picture) -> None:
        """pixels are scene-linear and premultiplied, as Blender expects them; Blender does the
        colour management afterwards.
        """
        import gpu
        from gpu_extras.presets import draw_texture_2d

        if self._texture is None or self.number != picture.number:
            height, width = picture.pixels.shape[:2]
            data = gpu.types.Buffer("FLOAT", height * width * 4, picture.pixels.reshape(-1))
            self._texture = gpu.types.GPUTexture((width, height), format="RGBA32F", data=data)
            self.number = picture.number
        x, y, width, height = picture.region
        gpu.state.blend_set("ALPHA_PREMULT")
        draw_texture_2d(self._texture, (x, y), width, height)
        gpu.state.blend_set("NONE")

    def clear(self) -> None:
        self._texture, self.number = None, 0
