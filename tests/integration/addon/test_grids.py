"""Volume objects and what is in their files, as the engine sees it."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from photon_splat.core.scene import Scene
from photon_splat.core.scene.grids import Grid, TooLarge, box, held, make_grid
from photon_splat.export.geometry.smoke import read_domain
from photon_splat.export.report import Report

from tests.support import stage
from tests.support.blender import in_blender


def _cloud(path: str, name: str = "Cloud", **nodes: Any) -> Any:
    """A volume object of a file with a Principled Volume; nodes: values of its inputs."""
    import bpy

    material, tree = stage.empty_material(name)
    node = tree.nodes.new("ShaderNodeVolumePrincipled")
    for key, value in nodes.items():
        node.inputs[key.replace("_", " ")].default_value = value
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
    data = bpy.data.volumes.new(name)
    data.filepath = path
    data.materials.append(material)
    return stage.add(name, data)


def _ramp(count: int = 10) -> np.ndarray:
    values = np.zeros((count, count, count), np.float32)
    values[1:-1, 2:-1, 1:-2] = np.arange(1, count - 1, dtype=np.float32)[:, None, None]
    return values


def _grids(what: Scene) -> list[Grid]:
    return [own.grid for mesh in what.meshes for own in mesh.shading.grids]


def _dense(grid: Grid) -> np.ndarray:
    """All its values (X, Y, Z, C)."""
    blocks = np.zeros((*grid.table.shape, *grid.values.shape[1:]), np.float32)
    blocks[grid.table >= 0] = grid.values[grid.table[grid.table >= 0]]
    x, y, z = grid.table.shape
    width = grid.values.shape[2]
    cubes = blocks.reshape(x, y, z, 8, 8, 8, width).transpose(0, 3, 1, 4, 2, 5, 6)
    return cubes.reshape(8 * x, 8 * y, 8 * z, width)


# --- bricks ---


def _from_array(values: np.ndarray, lower: tuple[int, int, int]) -> tuple[Grid, int]:
    def read(first: tuple[int, int, int], shape: tuple[int, int, int]) -> np.ndarray:
        out = np.zeros((*shape, values.shape[3]), np.float32)
        for at in np.ndindex(*shape):
            index = tuple(f + k - low for f, k, low in zip(first, at, lower, strict=True))
            if all(0 <= i < n for i, n in zip(index, values.shape[:3], strict=True)):
                out[at] = values[index]
        return out

    upper = tuple(low + n - 1 for low, n in zip(lower, values.shape[:3], strict=True))
    return make_grid(read, lower, upper, np.eye(4), np.zeros(values.shape[3], np.float32))  # type: ignore[arg-type]


def test_bricks_hold_what_was_read() -> None:
    values = np.random.default_rng(1).normal(size=(11, 5, 20, 3)).astype(np.float32)
    values[:, :, 6:18] = 0.0
    grid, bad = _from_array(values, (-3, 9, -17))
    assert bad == 0
    assert grid.lower.tolist() == [-8, 8, -24]
    whole = _dense(grid)
    assert np.array_equal(whole[5:16, 1:6, 7:27], values)
    assert np.count_nonzero(whole) == np.count_nonzero(values)
    assert (grid.table < 0).any()
    found = held(grid, 0.0)
    assert found is not None
    assert [end.tolist() for end in found] == [[-3, 9, -17], [7, 13, 2]]
    assert held(grid, 100.0) is None


def test_what_is_no_number_is_counted_and_0() -> None:
    values = np.ones((4, 4, 4, 1), np.float32)
    values[1, 2, 3], values[0, 0, 0] = np.nan, np.inf
    grid, bad = _from_array(values, (0, 0, 0))
    assert bad == 2
    assert _dense(grid).sum() == 62


def test_a_grid_of_absurd_size_is_refused() -> None:
    with pytest.raises(TooLarge):
        make_grid(
            lambda *_: pytest.fail("read"),
            (0, 0, 0),
            (100_000, 100_000, 100_000),
            np.eye(4),
            np.zeros(1, np.float32),
        )


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_box_is_closed_and_faces_outwards(mirrored: bool) -> None:
    matrix = np.diag((2.0, 1.0, -3.0 if mirrored else 3.0, 1.0))
    positions, triangles = box(np.array((0, 0, 0)), np.array((1, 1, 1)), matrix)
    a, b, c = (positions[triangles[:, k]].astype(np.float64) for k in range(3))
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6 == pytest.approx(6.0)
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert set(np.unique(edges, axis=0, return_counts=True)[1].tolist()) == {2}


# --- volume objects ---


@pytest.mark.smoke
@in_blender
def test_a_volume_is_the_box_around_its_grid(tmp_path: str) -> None:
    from tests.support import vdb

    values = _ramp()
    grid = vdb.grid("density", values, 0.5, (1.0, 2.0, 3.0))
    ob = _cloud(vdb.write(Path(tmp_path, "a.vdb"), grid))
    ob.location = (0, 0, 5)
    what = stage.exported()
    assert what.warnings == []
    (found,) = _grids(what)
    index = found.to_index @ np.array((1.5, 2.5, 3.5, 1.0))
    assert index[:3] == pytest.approx([1, 1, 1])
    start = -found.lower
    inner = tuple(slice(int(s), int(s) + 8) for s in start)
    assert np.allclose(_dense(found)[inner][..., 0], values[:8, :8, :8])
    # held voxels 1..8, 2..8 and 1..7, and one more on both sides
    positions = what.meshes[0].positions
    assert positions.min(axis=0) == pytest.approx([1.0, 2.5, 3.0])
    assert positions.max(axis=0) == pytest.approx([5.5, 6.5, 7.0])
    assert what.instances.matrix[0, 2, 3] == 5
    assert what.materials[0].volume >= 0


@in_blender
def test_only_grids_that_the_material_asks_for_are_read(tmp_path: str) -> None:
    from tests.support import vdb

    grids = [vdb.grid(name, _ramp(), 0.1) for name in ("density", "heat", "temperature")]
    path = vdb.write(Path(tmp_path, "a.vdb"), *grids)
    _cloud(path)
    assert len(_grids(stage.exported())) == 1
    hot = _cloud(path, "Hot", Blackbody_Intensity=1.0)
    bpy_remove("Cloud")
    assert len(_grids(stage.exported())) == 2
    hot.data.materials.clear()
    hot.data.materials.append(stage.material("Plaster"))
    assert stage.exported().meshes == []


def bpy_remove(name: str) -> None:
    import bpy

    bpy.data.objects.remove(bpy.data.objects[name])


@in_blender
def test_instances_share_a_grid_and_thin_it_by_their_size(tmp_path: str) -> None:
    from tests.support import vdb

    ob = _cloud(vdb.write(Path(tmp_path, "a.vdb"), vdb.grid("density", _ramp(), 0.1)))
    other = stage.add("Other", ob.data)
    other.scale = (2, 2, 2)
    what = stage.exported()
    assert len(what.meshes) == 1
    assert what.instances.density is not None
    assert sorted(what.instances.density.tolist()) == [0.5, 1.0]
    ob.data.render.space = "WORLD"
    assert stage.exported().instances.density is None


@in_blender
def test_frames_of_a_sequence(tmp_path: str) -> None:
    from tests.support import vdb

    for frame in (1, 2, 3):
        grid = vdb.grid("density", frame * np.ones((4, 4, 4), np.float32), 0.1)
        vdb.write(Path(tmp_path, f"smoke_{frame:04}.vdb"), grid)
    data = _cloud(str(Path(tmp_path, "smoke_0001.vdb"))).data
    data.is_sequence, data.frame_duration, data.frame_start = True, 3, 11
    data.sequence_mode = "CLIP"

    def largest(frame: int) -> float:
        stage.scene().frame_set(frame)
        return max([float(grid.values.max()) for grid in _grids(stage.exported())], default=0.0)

    assert [largest(frame) for frame in (10, 11, 12, 13, 14)] == [0, 1, 2, 3, 0]
    data.sequence_mode = "REPEAT"
    assert [largest(frame) for frame in (14, 15)] == [1, 2]
    data.frame_offset = 1
    assert largest(11) == 2


@in_blender
def test_a_missing_file_is_named(tmp_path: str) -> None:
    _cloud(str(Path(tmp_path, "nothing.vdb")), "Lost")
    what = stage.exported()
    assert what.meshes == []
    assert "'Lost'" in stage.the_one_warning(what)
    broken = Path(tmp_path, "broken.vdb")
    broken.write_bytes(b"no grid at all")
    bpy_remove("Lost")
    _cloud(str(broken), "Broken")
    assert "'Broken'" in stage.the_one_warning(stage.exported())


@in_blender
def test_empty_grids_are_nothing(tmp_path: str) -> None:
    from tests.support import vdb

    for count in (0, 4):
        values = np.zeros((6, 6, 6), np.float32)
        values[:count] = 1e-5  # below the clipping
        _cloud(vdb.write(Path(tmp_path, f"{count}.vdb"), vdb.grid("density", values)))
    what = stage.exported()
    assert (what.meshes, what.warnings) == ([], [])


@in_blender
def test_grids_that_are_not_finite_are_named(tmp_path: str) -> None:
    from tests.support import vdb

    values = _ramp()
    values[4, 4, 4], values[5, 5, 5] = np.nan, np.inf
    _cloud(vdb.write(Path(tmp_path, "a.vdb"), vdb.grid("density", values)), "Odd")
    what = stage.exported()
    assert "'Odd'" in stage.the_one_warning(what)
    assert np.isfinite(_grids(what)[0].values).all()


@in_blender
def test_an_absurd_grid_is_named(tmp_path: str) -> None:
    from tests.support import vdb

    grid = vdb.grid("density", _ramp())
    grid.fill((0, 0, 0), (1023, 1023, 1023), 1.0)
    _cloud(vdb.write(Path(tmp_path, "a.vdb"), grid), "Ocean")
    what = stage.exported()
    assert what.meshes == []
    assert "'Ocean'" in stage.the_one_warning(what)


@in_blender
def test_a_blender_without_the_module_says_so(tmp_path: str) -> None:
    from photon_splat.export.geometry import vdb as files

    from tests.support import vdb

    _cloud(vdb.write(Path(tmp_path, "a.vdb"), vdb.grid("density", _ramp())), "Cloud")
    found = files.module
    files.module = lambda: None  # type: ignore[assignment]
    try:
        said = stage.the_one_warning(stage.exported())
    finally:
        files.module = found
    assert "no openvdb module" in said
    assert "'Cloud'" in said


@in_blender
def test_volumes_that_modifiers_make() -> None:
    import bpy

    ball = stage.plane("Ball")
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.5)
    ball = bpy.context.object
    ball.hide_render = True
    stage.scene().objects["Ball"].hide_render = True
    ob = _cloud("", "Filled")
    modifier = ob.modifiers.new("Fill", "MESH_TO_VOLUME")
    modifier.object, modifier.density = ball, 2.0
    modifier.resolution_mode, modifier.voxel_amount = "VOXEL_AMOUNT", 16
    what = stage.exported()
    (grid,) = _grids(what)
    assert grid.values.max() == pytest.approx(2.0)
    assert np.abs(what.meshes[0].positions).max() < 0.8


# --- smoke ---


class _Values:
    """An array of Blender's."""

    def __init__(self, values: np.ndarray) -> None:
        self._values = values.ravel()

    def __len__(self) -> int:
        return len(self._values)

    def foreach_get(self, out: np.ndarray) -> None:
        out[:] = self._values


def _domain(**grids: np.ndarray) -> Any:
    found = {f"{name}_grid": _Values(values) for name, values in grids.items()}
    return SimpleNamespace(
        domain_resolution=(4, 6, 8),
        use_noise=False,
        noise_scale=2,
        clipping=0.01,
        cache_frame_start=1,
        cache_frame_end=10,
        **found,
    )


BOX = SimpleNamespace(
    name="Domain",
    data=SimpleNamespace(texspace_location=(1.0, 2.0, 3.0), texspace_size=(1.0, 1.5, 2.0)),
)


def test_grids_of_a_domain_stand_where_cycles_puts_them() -> None:
    density = np.random.default_rng(2).random((8, 6, 4)).astype(np.float32)  # x fastest
    color = np.zeros((8, 6, 4, 4), np.float32)
    color[1, 2, 3] = (0.1, 0.2, 0.3, 0.5)
    domain, report = _domain(density=density, color=color), Report()
    found = read_domain(BOX, domain, {7: "density", 8: "color", 9: "flame"}, 5, report)
    assert [own.id for own in found] == [7, 8]
    whole = _dense(found[0].grid)
    assert whole[3, 2, 1, 0] == density[1, 2, 3]
    assert np.array_equal(_dense(found[1].grid)[3, 2, 1], color[1, 2, 3])
    to_object = np.linalg.inv(found[0].grid.to_index)
    # the middle of a voxel of 0.5 m, and a 4th, 6th and 8th of 1 m
    assert (to_object @ (0, 0, 0, 1))[:3] == pytest.approx(
        [0.25 + 1 / 4, 0.75 + 1 / 6, 1.25 + 1 / 8]
    )
    assert (to_object @ (1, 1, 1, 0))[:3] == pytest.approx([0.5, 0.5, 0.5])
    assert report.messages() == []


def test_a_domain_without_cache_is_named() -> None:
    report = Report()
    assert read_domain(BOX, _domain(density=np.zeros(0)), {7: "density"}, 5, report) == []
    assert "'Domain'" in report.messages()[0]
    later = Report()
    density = np.ones((8, 6, 4), np.float32)
    assert read_domain(BOX, _domain(density=density), {7: "density"}, 11, later) == []
    assert later.messages() == []


@in_blender
def test_a_domain_is_no_mesh() -> None:
    ob = _cloud("", "Unused")
    box = stage.plane("Smoke")
    box.data.materials[0] = ob.data.materials[0]
    box.modifiers.new("Fluid", "FLUID").fluid_type = "DOMAIN"
    box.modifiers["Fluid"].domain_settings.domain_type = "GAS"
    what = stage.exported()
    assert what.meshes == []
    assert "'Smoke'" in stage.the_one_warning(what, lambda warning: "Smoke domains" in warning)


@in_blender
def test_the_rest_of_a_scene_knows_no_grids() -> None:
    """A material on a mesh and on a volume is compiled for both, and asks grids in one alone."""
    from photon_splat.export.nodes.values import operations

    ob = _cloud("", "Fog")
    stage.plane("Box").data.materials[0] = ob.data.materials[0]
    what = stage.exported()
    opcode = operations()["GridValue"].opcode
    assert len(what.materials) == 2
    with_grids = [opcode in what.programs[made.volume].code.tolist() for made in what.materials]
    assert sorted(with_grids) == [False, True]
