"""The parts of the page from other sources: Pyodide, rulec's own wheel, libraries."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from tools.programs import ROOT, MissingPartError, put_packages, run

HERE = Path(__file__).resolve().parent

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


def put_pyodide(folder: Path, work: Path) -> None:
    """Put the files of Pyodide, in the release in ``package-lock.json``, into a folder."""
    put_packages(HERE, work)
    folder.mkdir()
    for name in PYODIDE_FILES:
        shutil.copy(work / "node_modules" / "pyodide" / name, folder)


def put_wheel(folder: Path) -> Path:
    """Build the wheel of this checkout into a folder; returns its path."""
    run([sys.executable, "-m", "hatchling", "build", "--target", "wheel", "-d", folder], ROOT)
    (wheel,) = folder.glob("rulec-*.whl")
    return wheel


def put_wheels(folder: Path) -> list[str]:
    """Put the wheels of rulec (this checkout) and msgspec into a folder; returns their names."""
    put_wheel(folder)
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
