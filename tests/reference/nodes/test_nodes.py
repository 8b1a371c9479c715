"""Node trees against Cycles: the number of cases that agree must not fall, and what cannot be
compiled is named.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from tests.support.paths import ROOT, environment

# IES Texture whose profile cannot be read: the picture is as in Cycles, but its user should know.
NAMED = [f"Material 'IES {why}'" for why in ("without text", "without file", "of no such file")]


@pytest.mark.smoke
def test_every_node_agrees_with_cycles(tmp_path: Path) -> None:
    """All cases are rendered at once, which is quick: hundreds of materials on one board."""
    found = tmp_path / "nodes.json"
    with tempfile.TemporaryDirectory() as home:
        command = [sys.executable, "-m", "tests.reference.nodes.run", "--json", str(found)]
        subprocess.run(command, cwd=ROOT, env=environment(home), check=True, capture_output=True)
    result = json.loads(found.read_text())
    print(f"{result['passed']} of {result['total']} cases of nodes agree with Cycles")
    assert result["failed"] == {}
    assert result["passed"] >= 900
    assert [said.split(",")[0] for said in result["warnings"]] == NAMED
