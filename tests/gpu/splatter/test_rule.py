"""The rule that chooses between the ways to splat, with made-up timings, and what it leaves in the
statistics.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from photon_splat.core.gpu import context, painter
from photon_splat.core.gpu.methods import merged
from photon_splat.core.gpu.rule import TRIALS, Rule, kind_of

from tests.support import corescene as c
from tests.support import gpu_scenes as scenes
from tests.support.opengl import need_method

BOTH = ("quads", "gather")
FEW, MANY = kind_of(1000, 100), kind_of(1_000_000, 100)


def splat(rule: Rule, kind: tuple[int, int], seconds: dict[str, float], batches: int) -> list[str]:
    """The methods taken, where each takes so many seconds a pair."""
    taken = []
    for pairs in range(1000, 1000 + batches):
        taken.append(rule.choose(kind, list(seconds)))
        rule.record(kind, taken[-1], pairs, pairs * seconds[taken[-1]])
    return taken


def test_each_kind_has_a_choice_of_its_own() -> None:
    rule = Rule()
    few, many = {"quads": 1.0, "gather": 2.0}, {"quads": 2.0, "gather": 1.0}
    for kind, seconds, faster in ((FEW, few, "quads"), (MANY, many, "gather")):
        taken = splat(rule, kind, seconds, 20)
        assert {name: taken[: 2 * TRIALS].count(name) for name in BOTH} == {
            "quads": TRIALS,
            "gather": TRIALS,
        }
        assert set(taken[2 * TRIALS :]) == {faster}
    assert rule.choices() == {"quads": 1, "gather": 1}
    assert rule.choose(FEW, BOTH) == "quads", (
        "what was learnt last has not changed what was learnt first"
    )


def test_one_slow_batch_does_not_decide() -> None:
    """As where another program uses the card."""
    rule = Rule()
    for name, times in (("quads", (1.0, 50.0, 1.0)), ("gather", (2.0, 2.0, 2.0))):
        for seconds in times:
            rule.record(FEW, name, 1, seconds)
    assert rule.choose(FEW, BOTH) == "quads"


def test_time_is_counted_by_the_pair() -> None:
    rule = Rule()
    for _ in range(TRIALS):
        rule.record(FEW, "quads", 2000, 3.0)
        rule.record(FEW, "gather", 1000, 2.0)
    assert rule.choose(FEW, BOTH) == "quads"


def test_one_method_needs_no_trials() -> None:
    rule = Rule()
    assert {rule.choose(FEW, ("quads",)) for _ in range(9)} == {"quads"}
    assert not rule.choices()


def test_kinds() -> None:
    assert kind_of(0, 0) == kind_of(0, 1)
    assert kind_of(1000, 10) == kind_of(1100, 11)
    assert len({kind_of(1000 * 4**k, 1000) for k in range(6)}) == 6, "by photons a block: radius x2"
    assert len({kind_of(10 * 16**k, 16**k) for k in range(6)}) == 6, "by blocks"


def test_merged_runs() -> None:
    runs = np.array(
        [(3, 0, 128), (3, 128, 128), (3, 256, 7), (5, 263, 1), (6, 264, 128), (6, 392, 2)],
        np.uint32,
    )
    assert np.array_equal(merged(runs), [(3, 0, 263), (5, 263, 1), (6, 264, 130)])
    assert np.array_equal(merged(runs[1:2]), runs[1:2])
    assert np.array_equal(merged(np.array([(0, 0, 4)], np.uint32)), [(0, 0, 4)])


@pytest.mark.usefixtures("opengl")
@pytest.mark.parametrize("faster", BOTH)
def test_a_render_keeps_to_the_faster(faster: str, monkeypatch: pytest.MonkeyPatch) -> None:
    need_method("gather")
    rule = Rule()
    record = rule.record
    monkeypatch.setattr(
        rule,
        "record",
        lambda kind, name, pairs, _: record(
            kind, name, pairs, pairs * (1.0 if name == faster else 2.0)
        ),
    )
    graphics = replace(context.submit(context.graphics).result(), rule=rule)
    monkeypatch.setattr(context, "graphics", lambda: graphics)
    gpu = c.shoot(
        scenes.room(16), backend="GPU", passes=8, photons_per_pass=50_000, adaptive_samples=False
    ).statistics["gpu"]
    used = gpu["methods"]
    assert sum(used.values()) == gpu["batches"] > 25
    assert used[faster] > 2 * min(used.values()) > 0


@pytest.mark.usefixtures("opengl")
def test_without_compute_shaders() -> None:
    """OpenGL 3.3: quads alone, and a sentence for who asks for more."""

    def on_thread() -> tuple[list[str], str]:
        real = context.graphics()
        old = SimpleNamespace(
            gl=SimpleNamespace(version_code=330, program=real.gl.program, buffer=real.gl.buffer),
            renderer="An old card",
            finish=real.finish,
            idle=real.idle,
        )
        plain = painter.Painter(old, SimpleNamespace())  # type: ignore[arg-type]
        names = list(plain.used)
        plain.release()
        with pytest.raises(ValueError, match="splat by") as raised:
            painter.Painter(old, SimpleNamespace(), "gather")  # type: ignore[arg-type]
        return names, str(raised.value)

    names, sentence = context.submit(on_thread).result()
    assert names == ["quads"]
    assert sentence == "An old card cannot splat by the method 'gather'; it can by quads"
