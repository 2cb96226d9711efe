"""Write ``.ci/requirements-dev.lock``: the releases that pip chooses for rulec's developers.

``python -m tools.lock``. They are resolved anew, whatever else the environment has.
"""

from __future__ import annotations

import json
import platform
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rulec.files import written_whole

ROOT = Path(__file__).resolve().parents[2]
LOCK = ROOT / ".ci" / "requirements-dev.lock"
HEAD = """\
# What rulec's developers and its workflow on Python {python} install, on {system} ({machine}).
# PIP_CONSTRAINT=.ci/requirements-dev.lock tests/run uses it; `.ci/task lock` writes it anew.
"""


def lock(report: Mapping[str, Any]) -> str:
    """Format pip's installation report as requirements, sorted by name."""
    environment = report["environment"]
    head = HEAD.format(
        python=environment["python_version"],
        system=environment["platform_system"],
        machine=environment["platform_machine"],
    )
    releases = sorted(
        f"{metadata['name'].lower().replace('_', '-')}=={metadata['version']}"
        for metadata in (item["metadata"] for item in report["install"])
        if metadata["name"] != "rulec"
    )
    return head + "\n".join([*releases, ""])


def resolved() -> Mapping[str, Any]:
    """Ask pip for the releases of a new environment with rulec's tests."""
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--dry-run", "--ignore-installed"]
    done = subprocess.run(
        [*pip, "--report", "-", f"{ROOT}[test]"], stdout=subprocess.PIPE, check=True
    )
    report: Mapping[str, Any] = json.loads(done.stdout)
    return report


def main() -> None:
    """Resolve, and write the lock."""
    text = lock(resolved())
    with written_whole(LOCK) as stream:
        stream.write(text.encode())
    print(f"wrote {LOCK.relative_to(ROOT)} for Python {platform.python_version()}")


if __name__ == "__main__":
    main()
