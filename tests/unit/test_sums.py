"""Sums of films: what is added is what one film would hold, bit for bit in any order, and what
does not go together is refused.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from photon_splat.core.render.parts import Part
from photon_splat.core.render.persistent import start_anew
from photon_splat.core.render.record import Checkpoint, Record
from photon_splat.core.render.session import render
from photon_splat.core.render.settings import RenderSettings
from photon_splat.core.render.sums import DifferentPictures, Sums, added, check_alike
from photon_splat.core.render.sums_file import SumsFile, SumsFileError, write_sums
from photon_splat.core.scene import LightKind, Scene

from tests.support import corescene

PIXELS = 24


def room(energy: float = 60.0) -> Scene:
    """A closed room with two boxes and a small lamp."""
    return corescene.scene(
        corescene.perspective((0, -1.9, 1.0), (0, 0, 0.8), PIXELS, PIXELS, 1.2),
        [
            (corescene.box((-2, -2, 0), (2, 2, 2), inwards=True), corescene.lambert(0.6)),
            (corescene.box((-0.9, 0.2, 0), (-0.2, 0.9, 1.1)), corescene.lambert(0.7)),
        ],
        [corescene.lamp(LightKind.POINT, energy, (1.2, 1.2, 1.6))],
    )


def settings(passes: int = 4, **more: object) -> RenderSettings:
    return RenderSettings(passes=passes, photons_per_pass=4000, **more)  # type: ignore[arg-type]


def sums_of(what: Scene, asked: RenderSettings, part: Part) -> Sums:
    record = Record(part, keeps=True)
    render(what, asked, started=time.monotonic(), record=record)
    assert record.total is not None
    return record.total


@pytest.fixture(scope="module")
def parts() -> list[Sums]:
    return [sums_of(room(), settings(), Part(number, 4)) for number in range(1, 5)]


def same(one: Sums, other: Sums) -> bool:
    return one.films == other.films and {
        name: plane.tobytes() for name, plane in one.planes.items()
    } == {name: plane.tobytes() for name, plane in other.planes.items()}


def test_part_one_of_one_is_a_render_like_any_other() -> None:
    ordinary = render(room(), settings(), started=time.monotonic())
    record = Record(Part(), keeps=True)
    kept = render(room(), settings(), started=time.monotonic(), record=record)
    assert record.total is not None
    again = record.total.film().film(["combined"])["combined"]
    for name, pixels in ordinary.passes.items():
        assert pixels.tobytes() == kept.passes[name].tobytes(), name
    assert again.tobytes() == ordinary.passes["Combined"].tobytes()
    error = record.total.film().error()
    for name, value in ordinary.statistics["error"].items():
        assert error[name] == pytest.approx(value, rel=1e-4)


def test_parts_are_independent_of_each_other(parts: list[Sums]) -> None:
    """Their noise falls as the root of their number."""
    films = [part.film().film(["combined"])["combined"][..., 0] for part in parts]
    mean = np.mean(films, axis=0)
    spread = np.mean(np.var(films, axis=0, ddof=1))
    first = np.mean(np.var([films[0], films[1]], axis=0, ddof=1))
    assert first > 0.3 * spread
    assert not np.array_equal(films[0], films[1])
    ordinary = render(room(), settings(64), started=time.monotonic())
    far = np.mean((mean - ordinary.passes["Combined"][..., 0]) ** 2)
    assert far < spread  # of one part; of four a quarter, and a little bias


def test_neither_order_nor_grouping_changes_a_bit(parts: list[Sums]) -> None:
    a, b, c, d = parts
    whole = added(parts)
    for other in (
        added([d, b, a, c]),
        added([added([a, b]), added([c, d])]),
        added([added([d, a]), c, b]),
        added([added([added([b, d]), c]), a]),
    ):
        assert same(whole, other)
    assert whole.passes == 16
    assert whole.samples == pytest.approx(sum(part.samples for part in parts))


def test_the_sum_is_that_of_float64(parts: list[Sums]) -> None:
    whole = added(parts)
    for name in ("sum.diffuse_indirect", "sum.samples", "error.variance", "error.square"):
        expected = sum(part.planes[name][0].astype(np.float64) for part in parts)
        assert np.array_equal(whole.planes[name].sum(0, dtype=np.float64), expected)
        assert np.array_equal(whole.planes[name][0], np.asarray(expected, np.float32))


def test_ids_and_depth_are_those_of_the_lowest_part(parts: list[Sums]) -> None:
    whole = added([parts[2], parts[0], parts[1]])
    for name in ("first.depth", "first.surface_id"):
        assert np.array_equal(whole.planes[name], parts[0].planes[name])


def test_what_does_not_go_together(parts: list[Sums]) -> None:
    asked = settings(1)
    for other, why in (
        (sums_of(room(61.0), asked, Part(5, 4)), "the scene is not the same"),
        (sums_of(room(), settings(1, seed=3), Part(5, 4)), "seed is 0 and 3"),
        (sums_of(room(), settings(1, max_bounces=2), Part(5, 4)), "max_bounces is 32 and 2"),
        (
            sums_of(room(), asked, Part(5, 5)),
            "the picture is planned for 4 parts and for 5",
        ),
    ):
        with pytest.raises(DifferentPictures) as refused:
            check_alike([parts[0], other], ["a", "b"])
        assert str(refused.value) == f"a and b do not go together: {why}"
    with pytest.raises(DifferentPictures, match=r"^part 1 is in a and in b$"):
        check_alike([parts[0], added(parts[:2])], ["a", "b"])
    check_alike([parts[0], sums_of(room(), asked, Part(5, 4))], ["a", "b"])


def test_a_file_holds_every_bit(parts: list[Sums], tmp_path: Path) -> None:
    whole = added(parts)
    write_sums(tmp_path / "p.exr", [whole])
    (read,) = SumsFile(tmp_path / "p.exr").read()
    assert same(read, whole)
    assert read.picture == whole.picture
    lower, upper = (SumsFile(tmp_path / "p.exr").rows(*rows)[0] for rows in ((0, 7), (7, PIXELS)))
    for name, plane in whole.planes.items():
        joined = np.concatenate([lower.planes[name], upper.planes[name]], axis=1)
        assert np.array_equal(joined, plane)


def test_a_file_that_is_cut_off_is_refused(parts: list[Sums], tmp_path: Path) -> None:
    write_sums(tmp_path / "p.exr", parts[:1])
    whole = (tmp_path / "p.exr").read_bytes()
    for share in (0.01, 0.5, 0.95):
        (tmp_path / "cut.exr").write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(SumsFileError, match=r"cut\.exr cannot be read: "):
            SumsFile(tmp_path / "cut.exr").read()


# --- checkpoints ---


def shoot(path: Path, passes: int, cancel_after: int | None = None) -> tuple[np.ndarray, Sums]:
    """A render with a checkpoint after each pass, which is cancelled after so many."""
    done = 0

    def pass_done() -> bool:
        return cancel_after is not None and record_passes() >= cancel_after

    def record_passes() -> int:
        return done

    def progress(told: object) -> None:
        nonlocal done
        done = told.passes_done  # type: ignore[attr-defined]

    record = Record(checkpoint=Checkpoint(path, every=0.0))
    result = render(
        room(),
        settings(passes),
        started=time.monotonic(),
        record=record,
        on_progress=progress,
        should_cancel=pass_done,
    )
    assert result.cancelled == (cancel_after is not None)
    assert record.total is not None
    return result.passes["Combined"], record.total


def test_a_checkpoint_changes_nothing(tmp_path: Path) -> None:
    ordinary = render(room(), settings(8), started=time.monotonic())
    with_checkpoint, _ = shoot(tmp_path / "c.exr", 8)
    assert np.array_equal(ordinary.passes["Combined"], with_checkpoint)


def test_a_render_goes_on_from_its_checkpoint(tmp_path: Path) -> None:
    path = tmp_path / "c.exr"
    _, before = shoot(path, 400, cancel_after=3)
    assert 3 <= before.passes < 400
    wanted = before.passes + 5
    picture, after = shoot(path, wanted)
    assert [film.name for film in after.films] == [(1, 0), (1, 1)]
    assert after.passes == wanted
    assert after.films[0] == before.films[0]
    assert np.array_equal(picture, after.film().film(["combined"])["combined"])
    again, same_sums = shoot(path, wanted)  # nothing is left to do
    assert np.array_equal(again, picture)
    assert same(same_sums, after)


def test_discs_are_those_of_the_whole() -> None:
    """The first pass of part 8 of 8 has the radii of the eighth pass, as the ninth one has that
    follows a checkpoint after eight.
    """
    what = room()
    asked = settings(9, adaptive_radius=False, adaptive_samples=False)
    start = start_anew(what, asked)
    start.prepare()
    whole = []
    for number in range(9):
        start.renderer.render_pass(number)
        whole.append(discs(start.renderer))
    paths = asked.photons_per_pass
    for part, number in (
        (Part(8, 8), 7),
        (Part(2, 8), 1),
        (Part(1, 1, 1, 8, (8 * paths,)), 8),
    ):
        other = start_anew(what, asked)
        part.tell(other.renderer)
        other.prepare()
        other.renderer.render_pass(0)
        assert discs(other.renderer) == pytest.approx(whole[number], rel=0.03)
    assert whole[0] > 1.5 * whole[8]  # 9^(1/3) = 2.08


def discs(renderer: Any) -> float:
    """Mean square of the radii of a pass, m^2."""
    return float(np.mean(renderer.points()["radius"] ** 2))


def test_a_checkpoint_of_another_scene_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "c.exr"
    shoot(path, 1)
    was = path.read_bytes()
    record = Record(checkpoint=Checkpoint(path))
    with pytest.raises(DifferentPictures) as refused:
        render(room(61.0), settings(2), started=time.monotonic(), record=record)
    assert str(refused.value) == (
        f"The checkpoint {path} is not of this render (the scene is not the same): remove it, or "
        "choose another file"
    )
    assert path.read_bytes() == was


def test_a_checkpoint_that_cannot_be_written_ends_no_render(tmp_path: Path) -> None:
    record = Record(checkpoint=Checkpoint(tmp_path / "gone" / "c.exr", every=0.0))
    result = render(room(), settings(2), started=time.monotonic(), record=record)
    assert result.statistics["passes"] == 2
    assert any(
        warning.startswith("There is no checkpoint of the last passes: ")
        for warning in result.statistics["warnings"]
    )
