"""Checkouts of older commits that are measured beside this one, each in its own environment."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path


def older_checkouts() -> list[Path]:
    """Those that RULEC_OLDER names, separated by colons."""
    return [Path(one) for one in os.environ.get("RULEC_OLDER", "").split(":") if one]


def commit(checkout: Path) -> str:
    """How a table calls a checkout: by the short name of its commit."""
    asked = ["git", "-C", str(checkout), "rev-parse", "--short=8", "HEAD"]
    found = subprocess.run(asked, capture_output=True, text=True, check=True)
    return f"commit {found.stdout.strip()}"


def python(checkout: Path) -> str:
    """The interpreter of its environment, or this one if it has none."""
    own = checkout / ".venv" / "bin" / "python"
    return str(own) if own.exists() else sys.executable


def environment(checkout: Path) -> dict[str, str]:
    """In which its package is imported."""
    return {**os.environ, "PYTHONPATH": str(checkout / "src")}


def german_rules(checkout: Path) -> Path:
    """Its rulebook `de`."""
    return checkout / "rulebooks" / "de" / "de.rules"
