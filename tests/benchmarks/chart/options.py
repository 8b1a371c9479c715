"""What a measurement is told to do: scenes, times, size, where its files go."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.benchmarks.chart.plan import BUDGETS, CASES, Case
from tests.benchmarks.chart.rivals import driver
from tests.support.paths import ROOT

FOLDER = Path(__file__).resolve().parent
"""Of the committed charts and tables, which have each scene's own size."""


@dataclass(frozen=True)
class Options:
    cases: list[Case]
    budgets: list[float]  # s
    seeds: int
    long: set[str]
    folder: Path


def size(text: str) -> tuple[int, int]:
    """Of "1920x1080"."""
    width, _, height = text.lower().partition("x")
    try:
        found = int(width), int(height)
    except ValueError:
        found = (0, 0)
    if min(found) < 8:
        raise argparse.ArgumentTypeError(f"{text} is no size like 1920x1080, of 8 pixels or more")
    return found


def add_choice(parser: argparse.ArgumentParser) -> None:
    """Options of every measurement of the plan's scenes."""
    parser.add_argument(
        "--scenes",
        nargs="+",
        default=[],
        choices=[case.scene for case in CASES],
        metavar="SCENE",
        help="of " + ", ".join(case.scene for case in CASES),
    )
    parser.add_argument(
        "--size",
        type=size,
        metavar="WIDTHxHEIGHT",
        help="of every picture, in place of each scene's own; files then go to out/chart/SIZE",
    )
    parser.add_argument(
        "--reference-seconds",
        type=float,
        metavar="S",
        help="of each of the two halves; by default the scene's own, longer for a larger picture "
        "by the square root of its pixels: its error then is known as well",
    )


def chosen(options: argparse.Namespace, also: Sequence[str] = ()) -> list[Case]:
    named = {*options.scenes, *also}
    return [
        case.sized(options.size, options.reference_seconds)
        for case in CASES
        if not named or case.scene in named
    ]


def folder_of(options: argparse.Namespace) -> Path:
    """Where the files of a measurement go."""
    if options.size is None:
        return FOLDER
    made = ROOT / "out" / "chart" / "{}x{}".format(*options.size)
    made.mkdir(parents=True, exist_ok=True)
    return made


def parsed(arguments: Sequence[str]) -> Options:
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.chart")
    add_choice(parser)
    parser.add_argument(
        "--times",
        type=float,
        nargs="+",
        default=list(BUDGETS),
        metavar="S",
        help="seconds that each method is given",
    )
    parser.add_argument("--seeds", type=int, default=5, help="at most, of the short renders")
    parser.add_argument(
        "--long",
        nargs="+",
        default=[],
        choices=[case.scene for case in CASES],
        metavar="SCENE",
        help="Cycles for a quarter of an hour on these",
    )
    parser.add_argument(
        "--rivals",
        type=Path,
        default=driver.python,
        metavar="PYTHON",
        help="that has mitsuba and pyluxcore",
    )
    options = parser.parse_args(arguments)
    driver.python = options.rivals
    return Options(
        chosen(options, options.long),
        sorted(options.times),
        options.seeds,
        set(options.long),
        folder_of(options),
    )
