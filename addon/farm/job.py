"""A job: one picture in parts, or an animation in chunks of frames, as commands of photon-splat."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from ..core.render.parts import too_small

MOST_TASKS = 1024
"""Values that Open Job Description lets a task have."""


class FarmError(ValueError):
    """Why there is no such job; one sentence."""


class System(StrEnum):
    OPENJD = "openjd"
    FLAMENCO = "flamenco"
    SLURM = "slurm"


@dataclass(frozen=True, slots=True)
class Still:
    """A frame in `parts` parts, which are merged."""

    frame: int
    parts: int

    def __post_init__(self) -> None:
        if not 1 <= self.parts <= MOST_TASKS:
            raise FarmError(f"{self.parts} parts are not between 1 and {MOST_TASKS}")


@dataclass(frozen=True, slots=True)
class Animation:
    """Frames, `chunk` of them in each task."""

    frames: tuple[int, ...]
    chunk: int

    def __post_init__(self) -> None:
        if not self.frames or self.chunk < 1:
            raise FarmError(f"there are no chunks of {self.chunk} of {len(self.frames)} frames")
        if len(self.chunks) > MOST_TASKS:
            raise FarmError(
                f"{len(self.chunks)} chunks of frames are more than {MOST_TASKS}: choose larger "
                "ones"
            )

    @property
    def chunks(self) -> list[str]:
        """Each as --frames takes it."""
        size = self.chunk
        return [ranges(self.frames[i : i + size]) for i in range(0, len(self.frames), size)]


def ranges(frames: Sequence[int]) -> str:
    """1-4,7 of the frames 1, 2, 3, 4, 7."""
    runs: list[list[int]] = []
    for frame in frames:
        if runs and frame == runs[-1][-1] + 1:
            runs[-1] = [runs[-1][0], frame]
        else:
            runs.append([frame])
    return ",".join("-".join(map(str, run)) for run in runs)


@dataclass(frozen=True, slots=True)
class Job:
    """name: of the picture's files. scene, output: the .blend file and the folder of results, as
    workers reach them. command: photon-splat on the workers. options: more of photon-splat
    render.
    """

    name: str
    scene: str
    output: str
    what: Still | Animation
    command: str = "photon-splat"
    options: tuple[str, ...] = ()

    def render(self, scene: str, output: str, task: str, count: str) -> list[str]:
        """Arguments of one task. The texts may be what a scheduler puts values in the place of.
        `task`: the number of a part, or a chunk. count: of parts.
        """
        progress = ["--progress", "openjd", "--mkdir"]
        if isinstance(self.what, Still):
            part = f"{self.name}.part_{task}.exr"
            return [
                "render",
                scene,
                "-o",
                f"{output}/parts/{part}",
                "--frame",
                str(self.what.frame),
                "--part",
                f"{task}/{count}",
                "--checkpoint",
                f"{output}/checkpoints/{part}",
                *progress,
                *self.options,
            ]
        return [
            "render",
            scene,
            "-o",
            f"{output}/{self.name}_####.exr",
            f"--frames={task}",
            "--skip-existing",
            "--strict",
            *progress,
            *self.options,
        ]

    def merge(self, output: str, count: str) -> list[str]:
        """Arguments of what follows the parts."""
        return ["merge", f"{output}/parts", "-o", f"{output}/{self.name}.exr", "--expect", count]

    def doubt(self) -> str:
        """A sentence if passes alone end its parts, and these are too few to pay; else none."""
        if not isinstance(self.what, Still) or self.what.parts == 1:
            return ""
        given: dict[str, str] = {}
        for i, word in enumerate(self.options):
            name, equals, value = word.partition("=")
            given[name] = value if equals else "".join(self.options[i + 1 : i + 2])
        passes = given.get("--passes", "")
        if "--seconds" in given or "--error" in given or not passes.isdecimal():
            return ""
        return too_small(int(passes))
