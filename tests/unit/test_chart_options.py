"""What the charts are told, and their tables; nothing is rendered."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from tests.benchmarks.chart import defaults, options, table
from tests.benchmarks.chart.plan import BUDGETS, CASES, Method


def test_every_scene_at_its_own_size_without_options() -> None:
    asked = options.parsed([])
    assert asked.cases == list(CASES)
    assert asked.budgets == list(BUDGETS)
    assert asked.folder == options.FOLDER


def test_a_short_measurement_at_another_size() -> None:
    asked = options.parsed(
        ["--size", "800x450", "--scenes", "kitchen", "interior", "--times", "30", "10"]
    )
    assert [(c.scene, c.width, c.height) for c in asked.cases] == [
        ("interior", 800, 450),
        ("kitchen", 800, 450),
    ]
    assert asked.budgets == [10.0, 30.0]
    assert asked.folder.name == "800x450"
    assert asked.folder != options.FOLDER


def test_larger_pictures_have_longer_references() -> None:
    case = next(c for c in CASES if c.scene == "interior")
    larger = case.sized((2 * case.width, 2 * case.height))
    assert larger.reference_seconds == 2 * case.reference_seconds
    assert case.sized(None) == case
    assert case.sized((64, 64), 5.0).reference_seconds == 5.0


@pytest.mark.parametrize("text", ["1920", "1920x", "x1080", "0x0", "wide"])
def test_what_is_no_size_is_refused(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        options.parsed(["--size", text])
    assert f"{text} is no size like 1920x1080, of 8 pixels or more" in capsys.readouterr().err


def test_rows_that_are_not_measured_anew_stay(tmp_path: Path) -> None:
    path = tmp_path / "figures.csv"

    def row(scene: str, budget: float, rmse: float) -> table.Row:
        return {"scene": scene, "method": Method.CYCLES.value, "budget": budget, "rmse": rmse}

    table.write(path, [row("street", 1.0, 0.5), row("interior", 3.0, 0.25)])
    table.write(path, [row("street", 1.0, 0.125), row("cornell_box", 1.0, 2.0)])
    with path.open(newline="") as file:
        found = [(r["scene"], float(r["rmse"])) for r in csv.DictReader(file)]
    assert found == [("cornell_box", 2.0), ("interior", 0.25), ("street", 0.125)]


def test_scenes_of_the_defaults_that_are_not_measured_anew_stay(tmp_path: Path) -> None:
    path = tmp_path / "defaults.csv"
    defaults.write(path, [["street", "8x8", "Cycles, defaults", "1", "2", "3", "1"]])
    defaults.write(path, [["car", "8x8", "Cycles, defaults", "4", "5", "6", "1"]])
    defaults.write(path, [["street", "8x8", "Cycles, defaults", "7", "8", "9", "1"]])
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0] == defaults.COLUMNS
    assert [(r[0], r[3]) for r in rows[1:]] == [("car", "4"), ("street", "7")]
