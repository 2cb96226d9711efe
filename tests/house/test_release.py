"""What a release is made of, and whether any of that is known to be vulnerable."""

import json
import os
import re
import subprocess
import sys

import pytest

from tools.programs import ROOT, environment
from tools.release.parts import put_bill

LOCK = ROOT / "src/launcher/locks/python{}.{}.txt".format(*sys.version_info)

pytestmark = pytest.mark.skipif(
    os.environ.get("RULEC_TEST_PROFILE") != "long", reason="installs programs: --long"
)


def released():
    """Name -> release, of the lock."""
    return dict(
        re.findall(r"^([\w.-]+)==([^\s;]+)", LOCK.read_text(encoding="utf-8"), re.MULTILINE)
    )


def test_the_bill_of_materials_has_every_locked_release(tmp_path):
    bill = json.loads(put_bill(tmp_path).read_text(encoding="utf-8"))
    assert bill["bomFormat"] == "CycloneDX"
    assert bill["metadata"]["component"]["name"] == "rulec"
    assert {part["name"]: part["version"] for part in bill["components"]} == released()


@pytest.mark.parametrize("lock", sorted(LOCK.parent.iterdir()), ids=lambda file: file.stem)
def test_no_locked_release_is_known_to_be_vulnerable(lock):
    python = environment("audit", "pip-audit>=2.7,<3") / "bin/python"
    audit = [python, "-m", "pip_audit", "--require-hashes", "--disable-pip"]
    done = subprocess.run(
        [*audit, "--format", "json", "-r", lock],
        capture_output=True,
        text=True,
        check=False,
    )
    if not done.stdout:
        pytest.skip(f"no advisories could be had: {done.stderr.splitlines()[-1]}")
    answers = json.loads(done.stdout)["dependencies"]
    audited = [answer for answer in answers if "vulns" in answer]
    if not audited:
        pytest.skip("the package index here gives no advisories")
    assert [answer for answer in audited if answer["vulns"]] == []
    # Of some the index may say nothing, but not of the largest.
    assert {"numpy", "shapely"} <= {answer["name"] for answer in audited}
