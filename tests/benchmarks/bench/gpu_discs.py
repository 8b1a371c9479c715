"""The seed's way, to compare with: each photon's disc projected into the image, where every pixel
has its point.

A point is a pinhole camera's first hit. For the benchmark only: the product splats onto sparse
points, in blocks that no camera has to see. A disc has one radius where points have each their own,
so that it misses some that would catch its photon.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from photon_splat.core.gpu import context
from photon_splat.core.gpu.painter import PHOTONS_PER_ROW
from photon_splat.core.gpu.quads import TEXTURES
from photon_splat.core.gpu.shaders import source
from photon_splat.core.native.fill import fill_renderer
from photon_splat.core.native.library import load
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.scene import Camera

if TYPE_CHECKING:
    from tests.benchmarks.bench.gpu_cases import Case

PATHS_PER_BATCH = 1 << 17
WIDER = 1.1
"""A photon's disc, over that of the point where it is: radii differ from point to point."""
VERTEX = (
    source("estimate.glsl", 330)
    + """
uniform mat4 view;    // world to clip space
in float radius;
flat out uvec4 hit, light;

void main() {
    int row = gl_InstanceID / int(PHOTONS_PER_ROW);
    ivec2 place = ivec2(2 * (gl_InstanceID % int(PHOTONS_PER_ROW)), row);
    hit = texelFetch(photons, place, 0);
    light = texelFetch(photons, place + ivec2(1, 0), 0);
    vec3 normal = direction(light.x);
    vec3 other = abs(normal.x) > 0.5 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
    vec3 tangent = normalize(cross(normal, other));
    vec2 corner = radius * (2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0);
    vec3 across = corner.x * tangent + corner.y * cross(normal, tangent);
    gl_Position = view * vec4(uintBitsToFloat(hit.xyz) + across, 1.0);
}
"""
)
FRAGMENT = (
    source("estimate.glsl", 330)
    + """
flat in uvec4 hit, light;
layout(location = 0) out vec4 sums;
layout(location = 1) out float narrow;

void main() {
    vec4 point = texelFetch(positions, ivec2(gl_FragCoord.xy), 0);
    uvec4 plane = texelFetch(planes, ivec2(gl_FragCoord.xy), 0);
    float relative = relative_distance(point, hit.xyz);
    sums = vec4(0.0);
    narrow = 0.0;
    if (relative < 1.0 && hit.w == plane.w) {
        vec3 normal = uintBitsToFloat(plane.xyz);
        vec3 power = uintBitsToFloat(light.yzw);
        add_photon(relative, normal, direction(light.x), power, sums, narrow);
    }
}
"""
)


def view_matrix(camera: Camera) -> NDArray[np.float64]:
    """World to clip space of a perspective camera, (4, 4)."""
    left, right, bottom, top = camera.screen
    near, far = 1e-3, 1e3  # nothing is nearer or farther in the benchmark's scene
    project = np.zeros((4, 4))
    project[0, 0], project[0, 2] = 2 / (right - left), (right + left) / (right - left)
    project[1, 1], project[1, 2] = 2 / (top - bottom), (top + bottom) / (top - bottom)
    project[2, 2], project[2, 3], project[3, 2] = (
        -(far + near) / (far - near),
        -2 * far * near / (far - near),
        -1,
    )
    return project @ np.linalg.inv(camera.matrix)


def pixels_of(
    positions: NDArray[np.float32], view: NDArray[np.float64], width: int, height: int
) -> tuple[NDArray[np.intp], ...]:
    """Indices of those that are in the picture, and their pixels (row * width + column)."""
    clip = np.column_stack([positions, np.ones(len(positions))]) @ view.T
    with np.errstate(divide="ignore", invalid="ignore"):
        at = (clip[:, :2] / clip[:, 3:] * 0.5 + 0.5) * (width, height)
    seen = np.flatnonzero(
        (clip[:, 3] > 0) & (at >= 0).all(axis=1) & (at < (width, height)).all(axis=1)
    )
    column, row = at[seen].astype(np.intp).T
    return seen, row * width + column


def measure_discs(case: Case, scene: Any) -> dict[str, Any]:
    """One pass of at least case.photons photons, a point per camera sample. gpu_ms: drawing alone.
    hits_per_photon, cpu_hits_per_photon: photons caught by the points that are pixels, from the
    discs and from the CPU splatter.
    """
    settings = RenderSettings(
        photons_per_pass=case.photons,
        radius_scale=case.radius,
        point_spacing=0.0,
        adaptive_indirect=False,
    )
    renderer = load().Renderer(0)
    fill_renderer(renderer, scene, settings)
    renderer.build()
    renderer.trace_camera(0)
    renderer.place_points(0)
    points = renderer.points()
    view = view_matrix(scene.camera)
    seen, at = pixels_of(points["position"], view, case.width, case.height)
    of_pixel = np.full(case.width * case.height, -1)
    of_pixel[at] = seen  # where several fall into one pixel the last one stays
    pixels = np.flatnonzero(of_pixel >= 0)
    who = of_pixel[pixels]
    position = np.full((len(of_pixel), 4), np.finfo(np.float32).max, np.float32)
    position[pixels] = np.column_stack([points["position"][who], points["radius"][who] ** -2.0])
    plane = np.zeros((len(of_pixel), 4), np.uint32)
    plane[pixels] = np.column_stack(
        [np.ascontiguousarray(points["normal"][who]).view(np.uint32), points["key"][who]]
    )
    widest = {key: points["radius"][points["key"] == key].max() for key in np.unique(points["key"])}
    drawer = context.submit(
        _Drawer,
        view,
        position.reshape(case.height, case.width, 4),
        plane.reshape(case.height, case.width, 4),
    ).result()
    done = first = fragments = 0
    while done < case.photons:
        renderer.trace_photons(first, min(PATHS_PER_BATCH, case.photons))
        count = renderer.photon_count
        rows = renderer.photon_rows(0, count, -(-count // PHOTONS_PER_ROW) * PHOTONS_PER_ROW)
        radius = np.zeros(count, np.float32)
        keys = rows.view(np.uint32)[:count, 3]
        for key, most in widest.items():
            radius[keys == key] = most
        seen, at = pixels_of(rows[:count, :3], view, case.width, case.height)
        nearest = of_pixel[at]
        same = (nearest >= 0) & (points["key"][nearest] == keys[seen])
        radius[seen[same]] = WIDER * points["radius"][nearest[same]]
        fragments += context.submit(drawer.draw, rows, radius).result()
        renderer.splat()
        done, first = done + count, first + PATHS_PER_BATCH
    count = context.submit(drawer.finish).result().reshape(-1)[pixels]
    return {
        "width": case.width,
        "height": case.height,
        "radius": case.radius,
        "drawn": "discs",
        "points": len(pixels),
        "photons": done,
        "fragments_per_photon": fragments / done,
        "hits_per_photon": float(count.sum()) / done,
        "cpu_hits_per_photon": float(renderer.points()["count"][who].sum()) / done,
        "gpu_ms": 1e3 * drawer.seconds,
    }


class _Drawer:
    """On the OpenGL thread."""

    def __init__(
        self, view: NDArray[np.float64], position: NDArray[np.float32], plane: NDArray[np.uint32]
    ) -> None:
        self._graphics = context.graphics()
        gl = self._graphics.gl
        self.seconds = 0.0
        size = position.shape[1], position.shape[0]
        self._program = gl.program(VERTEX, FRAGMENT)
        self._program["view"] = tuple(view.T.astype(np.float32).ravel())
        self._points = [
            gl.texture(size, 4, position, dtype="f4"),
            gl.texture(size, 4, plane, dtype="u4"),
        ]
        self._sums = [gl.texture(size, 4, dtype="f4"), gl.texture(size, 1, dtype="f4")]
        self._frame = gl.framebuffer(self._sums)
        self._frame.clear()
        self._fragments = gl.query(samples=True)
        for unit, name in enumerate(TEXTURES[:3]):
            if name in self._program:
                self._program[name] = unit

    def draw(self, rows: NDArray[np.float32], radius: NDArray[np.float32]) -> int:
        """Fragments drawn."""
        gl, graphics = self._graphics.gl, self._graphics
        photons = gl.texture(
            (2 * PHOTONS_PER_ROW, len(rows) // PHOTONS_PER_ROW),
            4,
            rows.view(np.uint32),
            dtype="u4",
        )
        radii = gl.buffer(radius)
        quads = gl.vertex_array(self._program, [(radii, "1f4/i", "radius")])
        self._frame.use()
        gl.enable_only(gl.BLEND)
        gl.blend_func = gl.ONE, gl.ONE
        for unit, texture in enumerate((*self._points, photons)):
            texture.use(unit)
        began = time.monotonic()
        with self._fragments, graphics.timer:
            quads.render(gl.TRIANGLE_STRIP, vertices=4, instances=len(radius))
        graphics.finish()
        self.seconds += (
            1e-9 * graphics.timer.elapsed if graphics.hardware else time.monotonic() - began
        )
        for thing in (quads, radii, photons):
            thing.release()
        return int(self._fragments.samples)

    def finish(self) -> NDArray[np.float32]:
        """Photons caught by each pixel, (H, W); gives everything back."""
        count = np.frombuffer(self._sums[0].read(), np.float32).reshape(
            self._sums[0].height, self._sums[0].width, 4
        )[..., 3]
        self._graphics.idle.use()
        for thing in (self._frame, *self._sums, *self._points, self._program):
            thing.release()
        return count
