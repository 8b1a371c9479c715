"""README, CONTRIBUTING and docs/: what they name exists, and what is generated is up to date."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")])
FOLDERS = ("addon", "blend_scenes", "docs", "native", "shaders", "tests", "tools")
LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"`([^`\n]+)`|^ {4,}(.+)$", re.MULTILINE)
PATH = re.compile(rf"(?<![\w./])(?:{'|'.join(FOLDERS)})/[\w./*-]*")
MODULE = re.compile(r"-m ((?:tests|blend_scenes)(?:\.\w+)+)")
TARGET = re.compile(r"(?<![\w-])make ([a-z][\w-]*)")
PLACEHOLDER = re.compile(r"\b[A-Z]{2,}\b")

each = pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)


def code_of(document: Path) -> str:
    return "\n".join(span or block for span, block in CODE.findall(document.read_text()))


def anchors_of(document: Path) -> set[str]:
    """As GitHub makes them of headings."""
    headings = re.findall(r"^#+ (.+)$", document.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


@each
def test_links_and_pictures_lead_somewhere(document: Path) -> None:
    links = [link for link in LINK.findall(document.read_text()) if "://" not in link]
    for link in links:
        path, _, anchor = link.partition("#")
        target = (document.parent / path).resolve() if path else document
        assert target.exists(), link
        assert not anchor or anchor in anchors_of(target), link


@each
def test_paths_exist(document: Path) -> None:
    for path in PATH.findall(code_of(document)):
        if not PLACEHOLDER.search(path):
            assert list(ROOT.glob(path.rstrip("./"))), path


@each
def test_modules_exist(document: Path) -> None:
    for module in MODULE.findall(code_of(document)):
        path = ROOT / module.replace(".", "/")
        assert path.with_suffix(".py").exists() or (path / "__main__.py").exists(), module


@each
def test_make_targets_exist(document: Path) -> None:
    targets = re.findall(r"^([a-z][\w-]*):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    for target in TARGET.findall(code_of(document)):
        assert target in targets, target


def test_every_document_can_be_reached_from_the_readme() -> None:
    linked = {
        (ROOT / link.partition("#")[0]).resolve()
        for link in LINK.findall((ROOT / "README.md").read_text())
    }
    assert set(DOCUMENTS) - {ROOT / "README.md"} <= linked


def test_the_readme_stays_short() -> None:
    assert 600 <= len((ROOT / "README.md").read_text().split()) <= 800


def test_the_list_of_nodes_is_up_to_date(tmp_path: Path) -> None:
    """`make node-list` writes it anew."""
    made = re.search(r"-m (\S+) docs/nodes\.md", (ROOT / "Makefile").read_text())
    assert made
    page = tmp_path / "nodes.md"
    subprocess.run([sys.executable, "-m", made[1], str(page)], cwd=ROOT, check=True)
    assert page.read_text() == (ROOT / "docs/nodes.md").read_text()


def test_the_manual_explains_every_option_and_setting() -> None:
    manual = (ROOT / "docs/manual.md").read_text()
    options = re.findall(r'"(--[\w-]+)"', (ROOT / "addon/cli/arguments.py").read_text())
    settings = re.findall(r"^    (\w+): \w+Property\(", properties(), re.MULTILINE)
    labels = re.findall(r'^        name="([^"]+)",$', properties(), re.MULTILINE)
    assert len(options) > 15
    assert len(settings) > 15
    assert [option for option in options if f"`{option}" not in manual] == []
    own = [name for name in settings if not name.startswith("use_pass_")]
    assert [name for name in own if f"`{name}`" not in manual] == []
    assert [label for label in labels if label.removeprefix("Viewport ") not in manual] == []


def properties() -> str:
    return (ROOT / "addon/blender/properties.py").read_text()
