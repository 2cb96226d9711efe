"""Build what a release has, and try it: ``python -m tools.release -o FOLDER``.

Exit status: 0; 1 if something is wrong with it; 2 if a part is not available, or the folder
contains other files.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

from rulec.version import __version__
from tools.playground.parts import put_wheel
from tools.programs import MissingPartError
from tools.release.installed import faults_of_wheel
from tools.release.pages import faults_of_site
from tools.release.parts import CHECKSUMS, put_bill, put_checksums, put_extension, put_site


def build(folder: Path, recordings: Path | None) -> None:
    """Write the whole release, or raise MissingPartError and leave the folder unchanged."""
    if folder.exists() and any(folder.iterdir()) and not (folder / CHECKSUMS).is_file():
        raise MissingPartError(f"{folder} contains other files: choose an empty folder")
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".release-") as temporary:
        release = Path(temporary, "release")
        release.mkdir()
        for part in (put_wheel, put_bill, put_extension):
            print(f"built {part(release).name}", flush=True)
        put_site(release / "site", recordings)
        shutil.make_archive(str(release / f"rulec-{__version__}-site"), "gztar", release, "site")
        print("built the site, with its playground and its gallery", flush=True)
        put_checksums(release)
        if folder.exists():
            folder.rename(Path(temporary, "before"))
        release.rename(folder)


def faults_of(folder: Path, pictures: Path | None) -> Iterator[str]:
    """What is wrong with a release, as a stranger meets it."""
    (wheel,) = folder.glob("*.whl")
    yield from chain(faults_of_wheel(wheel), faults_of_site(folder / "site", pictures))


def main() -> int:
    """Build a release, try it, and print what is wrong."""
    parser = argparse.ArgumentParser(prog=".ci/task release", description=build.__doc__)
    parser.add_argument("-o", "--output", type=Path, required=True, help="the folder to write")
    parser.add_argument(
        "--recordings", type=Path, help="where recordings of others are, instead of fetching them"
    )
    parser.add_argument("--pictures", type=Path, help="a folder for pictures of all pages")
    given = parser.parse_args()
    folder = given.output.absolute()
    if given.pictures is not None:
        given.pictures.mkdir(parents=True, exist_ok=True)
    found = 0
    try:
        build(folder, given.recordings)
        for found, fault in enumerate(faults_of(folder, given.pictures), start=1):  # noqa: B007
            print(f"fault: {fault}", flush=True)
    except MissingPartError as error:
        print(f"release: {error}", file=sys.stderr)
        return 2
    print(f"{folder} is " + (f"not fit for release: {found} faults" if found else "a release"))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
