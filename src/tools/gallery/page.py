"""The gallery's page: a picture and a sentence of each drive, and the page that plays it.

Everything is drawn by ``rulec draw drive``.
"""

from __future__ import annotations

import re
import shlex
import sys
import tempfile
from collections.abc import Iterable
from html import escape
from pathlib import Path

import rulec
from tools.gallery.drives import GalleryDrive, Recorded
from tools.gallery.recordings import put_recording
from tools.programs import ROOT, run

HERE = Path(__file__).resolve().parent

_NUMBERS = r"M([\d.]+),([\d.]+) ([\d.]+),[\d.]+ [\d.]+,([\d.]+)"
_ROAD = re.compile(f'<path class="verge"[^>]* d="{_NUMBERS}')
_SHOWN = 560, 240
"""How much of a picture's road is shown on the page, in pixels: what is around ego."""


def build(folder: Path, drives: Iterable[GalleryDrive], recordings: Path | None = None) -> None:
    """Write the gallery into a new folder.

    Recordings of others are read from a folder of them, or fetched. Raises MissingPartError.
    """
    folder.mkdir()
    titles = {book.name: book.title for book in rulec.list()}
    cards = []
    with tempfile.TemporaryDirectory() as work:
        for drive in drives:
            told = _draw(drive, folder, _data(drive, Path(work), recordings))
            view = _view((folder / f"{drive.name}.svg").read_text("utf-8"))
            cards.append(_card(drive, titles[drive.book], view, told))
    page = (HERE / "page.html").read_text("utf-8").replace("{{cards}}", "\n".join(cards))
    (folder / "index.html").write_text(page, "utf-8")


def _data(drive: GalleryDrive, work: Path, recordings: Path | None) -> Path:
    if isinstance(drive.data, Recorded):
        return put_recording(drive.data, work, recordings)
    return Path(drive.data.path)


def _draw(drive: GalleryDrive, folder: Path, data: Path) -> str:
    """Draw a drive as a page and as a picture; returns the command."""
    options = ["-r", drive.book, "--ego", drive.ego, "--rule", drive.rule]
    if not isinstance(drive.data, Recorded) and drive.data.net:
        options += ["--map", drive.data.net]
    for value in drive.assumed:
        options += ["--assume", value]
    for ending in ("html", "svg"):
        command = ["draw", "drive", str(data), *options, "-o"]
        run([sys.executable, "-m", "rulec", *command, folder / f"{drive.name}.{ending}"], ROOT)
    shown = data.name if isinstance(drive.data, Recorded) else str(data)
    return shlex.join(["rulec", "draw", "drive", shown, *options, "-o", f"{drive.name}.html"])


def _card(drive: GalleryDrive, title: str, view: str, command: str) -> str:
    width, height = _SHOWN
    picture = f"{drive.name}.svg#svgView(viewBox({view}))"
    return f"""<li>
<a href="{drive.name}.html">
<img src="{picture}" width="{width}" height="{height}" alt="">
<h2>{escape(drive.title)}</h2>
</a>
<p>{escape(drive.sees)}</p>
<p class="from">Law: {escape(title)} (<code>{drive.book}</code>). {_source(drive)}</p>
<details><summary>The command</summary><code>{escape(command)}</code></details>
</li>"""


def _view(picture: str) -> str:
    """The part of a picture that is shown: x, y, width and height, around the road's middle."""
    found = _ROAD.search(picture)
    assert found is not None, "a picture of a drive has a road"
    left, top, right, bottom = map(float, found.groups())
    width, height = _SHOWN
    return f"{(left + right - width) / 2:g},{(top + bottom - height) / 2:g},{width},{height}"


def _source(drive: GalleryDrive) -> str:
    data = drive.data
    if not isinstance(data, Recorded):
        return escape(data.about)
    address = f"https://github.com/{data.repository}/blob/{data.commit}/{data.path}"
    return f'<a href="{address}">{data.name}</a>: {escape(data.about)}; {data.licence}.'
