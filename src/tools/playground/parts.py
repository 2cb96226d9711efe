"""The parts of the page from other sources: Pyodide, rulec's own wheel, libraries."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]

PYODIDE_FILES = (
    "pyodide.mjs",
    "pyodide.asm.mjs",
    "pyodide.asm.wasm",
    "python_stdlib.zip",
    "pyodide-lock.json",
)
"""Python itself, from the package ``pyodide``: Python 3.14 in WebAssembly.

It is the release for which PyPI has a build of msgspec.
"""

PLATFORM = (
    "--platform",
    "pyemscripten_2026_0_wasm32",
    "--python-version",
    "3.14",
    "--abi",
    "cp314",
)

LIBRARIES = ("click", "lark", "typing_extensions")
"""The pure-Python packages that the page's questions import, copied from this environment."""


class MissingPartError(Exception):
    """A part of the page is not available."""


def put_pyodide(folder: Path, work: Path) -> None:
    """Put the files of Pyodide, in the release in ``package-lock.json``, into a folder."""
    npm = shutil.which("npm")
    if npm is None:
        raise MissingPartError("npm is not found, which Pyodide is installed with: install Node.js")
    for name in ("package.json", "package-lock.json"):
        shutil.copy(HERE / name, work)
    run([npm, "ci", "--omit=dev", "--ignore-scripts", "--no-audit", "--no-fund", "--silent"], work)
    folder.mkdir()
    for name in PYODIDE_FILES:
        shutil.copy(work / "node_modules" / "pyodide" / name, folder)


def put_wheels(folder: Path) -> list[str]:
    """Put the wheels of rulec (this checkout) and msgspec into a folder; returns their names."""
    run([sys.executable, "-m", "hatchling", "build", "--target", "wheel", "-d", folder], ROOT)
    ready = ("--only-binary", ":all:", "--no-deps", "--require-hashes", *PLATFORM)
    wanted = ("--requirement", HERE / "requirements.txt", "--dest", folder, "--quiet")
    run([sys.executable, "-m", "pip", "download", *ready, *wanted], folder)
    return sorted(path.name for path in folder.glob("*.whl"))


def put_libraries(archive: Path) -> None:
    """Write the libraries' modules and licences, as they are installed here."""
    with ZipFile(archive, "w", ZIP_DEFLATED) as stream:
        for name, path in sorted(_files()):
            # Without file times, the same libraries always give the same archive.
            stream.writestr(ZipInfo(name), path.read_bytes(), ZIP_DEFLATED)


def _files() -> Iterator[tuple[str, Path]]:
    for library in LIBRARIES:
        try:
            files = distribution(library).files or ()
        except PackageNotFoundError as error:
            raise MissingPartError(f"{library} is not installed: call ./rulec once") from error
        for file in files:
            name, inside = file.as_posix(), ".dist-info/" in file.as_posix()
            if ".." not in name and (inside or file.suffix == ".py"):
                yield name, Path(str(file.locate()))


def run(command: Sequence[str | Path], folder: Path) -> None:
    """Run a tool in a folder. Raises MissingPartError with its output if it fails."""
    done = subprocess.run(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False
    )
    if done.returncode != 0:
        said = done.stdout.decode(errors="replace").strip()
        raise MissingPartError(f"{Path(command[0]).name} ended with {done.returncode}:\n{said}")
