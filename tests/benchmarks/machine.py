"""On what figures were measured."""

from __future__ import annotations

import os
import platform
from importlib.metadata import version
from pathlib import Path

LIBRARIES = {"numpy": "numpy", "Spot": "spottl", "Shapely": "shapely", "click": "click"}


def load() -> float:
    """How many processes have wanted a processor, on average over the last minute."""
    return os.getloadavg()[0]


def machine(load_before: float) -> list[str]:
    """A line for each thing that matters."""
    libraries = ", ".join(f"{name} {version(package)}" for name, package in LIBRARIES.items())
    return [
        f"{os.cpu_count()} cores: {processor()}",
        f"{platform.system()} {platform.release()}, {platform.machine()}",
        f"{platform.python_implementation()} {platform.python_version()}, {libraries}",
        f"load average {load_before:.1f} before, {load():.1f} after",
    ]


def processor() -> str:
    """The processor's model."""
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        name, _, value = line.partition(":")
        if name.strip() == "model name":
            return value.strip()
    return platform.processor()
