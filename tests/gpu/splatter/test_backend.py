"""Which splatter is used, and what is said where it cannot be had."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import pytest
from photon_splat.core.gpu import context, splatter
from photon_splat.core.render.settings import Integrator

from tests.support import corescene as c
from tests.support import gpu_scenes as scenes

SMALL = {"passes": 1, "photons_per_pass": 1000, "adaptive_indirect": False}
CARD = "NVIDIA GeForce RTX 4090/PCIe/SSE2"


def shoot(**settings: object) -> dict:
    return c.shoot(scenes.floor(8), **(SMALL | settings)).statistics


@pytest.mark.parametrize(
    ("renderer", "hardware"),
    [
        ("llvmpipe (LLVM 15.0.6, 256 bits)", False),
        ("softpipe", False),
        ("Software Rasterizer", False),
        ("Google SwiftShader", False),
        ("ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero)), SwiftShader driver)", False),
        ("Mesa DRI swrast", False),
        ("GDI Generic", False),
        ("Apple Software Renderer", False),
        ("D3D12 (Microsoft Basic Render Driver)", False),
        (CARD, True),
        ("AMD Radeon RX 7900 XTX (radeonsi, navi31, LLVM 17.0.6, DRM 3.57)", True),
        ("Mesa Intel(R) UHD Graphics 620 (KBL GT2)", True),
        ("Apple M2", True),
    ],
)
def test_hardware_by_name(renderer: str, hardware: bool) -> None:
    assert context.is_hardware(renderer) == hardware


@pytest.mark.parametrize("backend", ["AUTO", "CPU"])
def test_a_card_splats_only_when_asked_to(backend: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(context, "submit", lambda *_: pytest.fail("the OpenGL thread was asked"))
    statistics = shoot(backend=backend)
    assert statistics["backend"] == "CPU"
    assert "gpu" not in statistics


@pytest.mark.usefixtures("opengl")
def test_gpu_by_name_takes_software_too() -> None:
    statistics = shoot(backend="GPU")
    assert statistics["backend"] == "GPU"
    gpu = statistics["gpu"]
    assert gpu["renderer"]
    assert gpu["batches"] == 1
    assert 0 < gpu["busy_seconds"] <= gpu["wall_seconds"]
    assert 0 < gpu["cpu_busy_seconds"] <= gpu["wall_seconds"]


@pytest.fixture
def no_context(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that may have a card, but whose driver makes no context."""

    def fail() -> None:
        raise Exception("eglInitialize failed (0x3001)")

    monkeypatch.setattr(context, "_graphics", None)
    monkeypatch.setattr(context, "_contexts", lambda: iter([fail]))


@pytest.mark.usefixtures("no_context")
def test_no_context() -> None:
    pytest.importorskip("moderngl")
    with pytest.raises(
        ValueError,
        match=r"^the GPU splatter needs OpenGL 3\.3, and no context could be made \(eglInitialize "
        r"failed",
    ):
        shoot(backend="GPU")


@pytest.mark.usefixtures("no_context")
@pytest.mark.parametrize("package", ["moderngl", "glcontext"])
def test_package_not_installed(package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(
        ValueError,
        match=rf"^the GPU splatter needs the Python package {package}, which is not installed$",
    ):
        shoot(backend="GPU")


@pytest.mark.usefixtures("opengl")
def test_set_up_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """A context that cannot do what it must, on a machine with a card."""
    real = context.submit(context.graphics).result()
    monkeypatch.setattr(context, "graphics", lambda: SimpleNamespace(gl=real.gl, hardware=True))
    monkeypatch.setattr(
        splatter, "Painter", lambda *_: (_ for _ in ()).throw(RuntimeError("GLSL Compiler failed"))
    )
    with pytest.raises(
        ValueError, match=r"^the GPU splatter could not be set up: GLSL Compiler failed$"
    ):
        shoot(backend="GPU")


def test_reference_integrator_says_so() -> None:
    statistics = shoot(backend="GPU", integrator=Integrator.REFERENCE)
    assert statistics["backend"] == "CPU"
    assert statistics["warnings"] == [
        "The reference integrator has been used: it runs on the CPU only."
    ]
