"""Write ``src/launcher/locks``: the releases that the launcher installs, with their hashes.

Run ``python -m tools.lock`` with uv on PATH. Releases are resolved again for each Python and all
platforms (Spot has a wheel for one only), including rulec's build tools and the installers.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from rulec.diagnostics import Source
from rulec.files.file_messages import WRONG_SETTINGS
from rulec.files.written_files import written_whole
from rulec.toml import parsed_toml

ROOT = Path(__file__).resolve().parents[2]
LOCKS = ROOT / "src" / "launcher" / "locks"
PYTHONS = ("3.10", "3.11", "3.12", "3.13", "3.14")
PURPOSES = {"": (), "-test": ("--extra", "test")}
"""Suffix of a lock's name -> what it contains beyond rulec's own requirements."""
UV = ("uv", "pip", "compile", "--quiet", "--universal", "--generate-hashes", "--no-header")
INSTALLERS = ("editables", "pip", "setuptools; python_version < '3.12'")
"""What hatchling also needs to install a checkout, and newer installers than Python's own."""
HEAD = """\
# What ./rulec installs on Python {python}{tests}. `.ci/task lock` writes it anew.
# Elsewhere: pip install --require-hashes -r THIS_FILE, or uv pip install with the same.
"""


def build_tools() -> tuple[str, ...]:
    """The requirements for building rulec, from pyproject.toml."""
    file = ROOT / "pyproject.toml"
    project = parsed_toml(Source(file.name, file.read_text(encoding="utf-8")), WRONG_SETTINGS, "")
    return tuple(project["build-system"]["requires"])


def lock(python: str, extras: tuple[str, ...]) -> str:
    """The requirements of a new environment, one release each, with the hashes of all its files."""
    with tempfile.TemporaryDirectory() as folder:
        tools = Path(folder) / "build.in"
        tools.write_text("\n".join([*build_tools(), *INSTALLERS, ""]), encoding="utf-8")
        command = [*UV, "--no-annotate", "--python-version", python, *extras]
        done = subprocess.run(
            [*command, str(ROOT / "pyproject.toml"), str(tools)], stdout=subprocess.PIPE, check=True
        )
    return done.stdout.decode("utf-8")


def main() -> None:
    """Resolve, and write the locks."""
    LOCKS.mkdir(exist_ok=True)
    for python in PYTHONS:
        for ending, extras in PURPOSES.items():
            file = LOCKS / f"python{python}{ending}.txt"
            tests = ", with its tests" if extras else ""
            text = HEAD.format(python=python, tests=tests) + lock(python, extras)
            with written_whole(file) as stream:
                stream.write(text.encode())
            print(f"wrote {file.relative_to(ROOT)}")


if __name__ == "__main__":
    try:
        main()
    except FileNotFoundError as error:
        sys.exit(f"{error.filename} is not found: pip install uv")
