"""make bench-gpu: the command runs, and never calls software's figures a card's."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from photon_splat.core.gpu import context

from tests.benchmarks.bench import gpu

pytestmark = pytest.mark.usefixtures("opengl")


@pytest.fixture
def software(monkeypatch: pytest.MonkeyPatch) -> context.Graphics:
    graphics = replace(context.submit(context.graphics).result(), renderer="llvmpipe")
    monkeypatch.setattr(context, "graphics", lambda: graphics)
    return graphics


def test_refuses_software(
    software: context.Graphics, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert gpu.main(["--quick", "-o", str(tmp_path / "x.json")]) == 1
    assert (
        "bench-gpu: llvmpipe runs on the CPU; these figures are for graphics cards"
        in capsys.readouterr().err
    )
    assert not list(tmp_path.iterdir())


def test_trial_run(
    software: context.Graphics, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny = {
        name: [replace(case, photons=500) for case in group[-2:]]
        for name, group in gpu.cases(quick=True).items()
    }
    monkeypatch.setattr(gpu, "cases", lambda _: tiny)
    assert gpu.main(["--software", "--quick", "-o", str(tmp_path / "x.json")]) == 0
    report = json.loads((tmp_path / "x.json").read_text())
    assert list(report["groups"]) == list(gpu.TITLES)
    assert all(
        row["gpu_ms"] > 0
        for name, rows in report["groups"].items()
        if name not in ("renders", "denoiser")
        for row in rows
    )
    discs = report["groups"]["pixels"][-1]
    assert discs["drawn"] == "discs"
    assert (
        0.8
        < discs["hits_per_photon"] / discs["cpu_hits_per_photon"]
        <= 1.001
        < discs["fragments_per_photon"]
    )
    assert report["groups"]["renders"][0]["wall_over_busiest"] >= 1
    text = (tmp_path / "x.md").read_text()
    assert text.startswith("# A trial run in software: these are no figures of a graphics card")
    assert all(title in text for title in gpu.TITLES.values())
    assert "the seed." not in text


def test_what_a_card_is_said_to_have_shown() -> None:
    million = {"width": 1920, "height": 1080, "photons": 2_000_000, "gpu_ms": 20.0, "cpu_ms": 600.0}
    render = {
        "backend": "GPU",
        "photons_per_pass": 1000,
        "wall_over_busiest": 1.2,
        "mass_share": 0.05,
    }
    report = {
        "machine": {"graphics_card": True},
        "groups": {"seed": [million], "renders": [render, {"backend": "CPU"}]},
    }
    assert gpu.sentences(report) == [
        "A million photons at 1920x1080: 10.0 ms on the card, 300.0 ms on the CPU, 740 ms by the "
        "seed.",
        "1000 photons a pass: wall time is 1.20 of the busier side's (NOT within 1.15); "
        "M(x) on the card could save 5.0 % of the render at most.",
    ]
