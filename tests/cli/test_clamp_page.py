"""The page of the clamp, as a reader follows it: from CAD to the factor against slipping."""

import json
import re
import subprocess
import sys

import pytest

from tests.scenes import ROOT

pytestmark = [pytest.mark.serial, pytest.mark.errors]
PAGE = ROOT / "docs" / "howto" / "clamp.md"
FRICTION, RADIUS, TORQUE = 0.15, 10.0, 30e3


def test_its_commands_give_its_numbers(tmp_path):
    (commands,) = re.findall(r"```sh\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(re.findall(r"^(fenics-contact|sed|cat)", commands, re.MULTILINE)) <= 8
    program = f"'{sys.executable}' -m fenics_contact"
    script = commands.replace("--out clamp/run", "--out clamp/run --set 'solver.errors=\"none\"'")
    script = script.replace("fenics-contact", program).replace("meshes/", f"{ROOT}/meshes/")
    done = subprocess.run(
        ["sh", "-ec", script], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    result = json.loads((tmp_path / "clamp" / "run" / "result.json").read_text())
    assert result["passed"], result["verdict"]
    (fit,) = (one for one in result["contacts"] if one["name"] == "collar-shaft")
    pressed = fit["quantities"]["pressure_integral"]
    # Those of a mesh twice as fine (docs/benchmarks.md).
    assert result["preloads"]["bolt_M6"]["force"] == pytest.approx(7878, rel=1e-3)
    assert pressed == pytest.approx(71_180, rel=3e-3)
    # What friction holds of a rotation about the shaft, and how much of it the torque uses.
    share = TORQUE / (FRICTION * RADIUS * pressed)
    assert result["slip_limit"]["parts"]["shaft"] == pytest.approx(share, rel=5e-3)
    factor = result["quantities"]["slip_factor"]
    assert result["slip_limit"]["kind"] == "load steps"
    assert 1 / share < factor < 1.2 / share  # the torque tightens the collar
    assert (tmp_path / "clamp" / "run" / "report.html").exists()
