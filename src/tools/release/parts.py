"""The parts of a release: extension, site and bill of materials; the wheel is the playground's."""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from hashlib import sha256
from pathlib import Path

from tools.gallery import page as gallery
from tools.gallery.drives import OF_OTHERS, OWN
from tools.playground import __main__ as playground
from tools.programs import ROOT, environment, npm, run

ANNOUNCED = (
    '<a href="gallery/index.html">Drives that break a rule</a> · '
    '<a href="playground/index.html">Playground</a>'
)
"""What stands above every page of a published site."""

CHECKSUMS = "SHA256SUMS"


def put_bill(folder: Path) -> Path:
    """Write the bill of materials (CycloneDX) of the locked releases; returns its path."""
    lock = "src/launcher/locks/python{}.{}.txt".format(*sys.version_info)
    python = environment("bom", "cyclonedx-bom>=7,<8") / "bin/python"
    told = ("--pyproject", "pyproject.toml", "--mc-type", "application", "--output-reproducible")
    bill = folder / "rulec.cdx.json"
    run([python, "-m", "cyclonedx_py", "requirements", *told, "-o", bill, lock], ROOT)
    return bill


def put_extension(folder: Path) -> Path:
    """Pack the extension for Visual Studio Code; returns its path."""
    with tempfile.TemporaryDirectory() as work:
        here = Path(work, "src/editors/vscode")
        unwanted = shutil.ignore_patterns("node_modules", "dist", "*.vsix", "LICENSE")
        shutil.copytree(ROOT / "src/editors/vscode", here, ignore=unwanted)
        shutil.copy(ROOT / "LICENSE", work)
        run([npm(), "run", "package"], here)
        (packed,) = here.glob("*.vsix")
        return Path(shutil.move(packed, folder / packed.name))


def put_site(folder: Path, recordings: Path | None) -> None:
    """Write the documentation with its playground and its gallery into a new folder.

    Recordings of others are read from a folder of them, or fetched.
    """
    built = ROOT / "docs/_build"
    shutil.rmtree(built, ignore_errors=True)
    told = f"html_theme_options.announcement={ANNOUNCED}"
    run([ROOT / ".ci/task", "docs", "-D", told], ROOT)
    shutil.copytree(built, folder, ignore=shutil.ignore_patterns(".doctrees", ".buildinfo"))
    (folder / ".nojekyll").touch()  # or GitHub leaves out the folders that begin with _
    (folder / "llms.txt").write_text(site_overview((ROOT / "llms.txt").read_text("utf-8")), "utf-8")
    playground.build(folder / "playground")
    gallery.build(folder / "gallery", (*OWN, *OF_OTHERS), recordings)


def site_overview(overview: str) -> str:
    """The checkout's ``llms.txt`` with links to the site's pages."""
    return re.sub(r"\(docs/(\w+)\.md", r"(\1.html", overview)


def put_checksums(folder: Path) -> None:
    """Write the digests of a folder's files, in the form that ``sha256sum --check`` reads."""
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name != CHECKSUMS)
    lines = [f"{sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in files]
    (folder / CHECKSUMS).write_text("".join(lines), "utf-8")
