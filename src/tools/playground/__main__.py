"""Write the playground into a folder: ``python -m tools.playground -o FOLDER``.

Exit status: 0, or 2 if a part is not available or the folder contains other files.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import sys
import tempfile
from pathlib import Path

import rulec
from tools.playground.parts import HERE, put_libraries, put_pyodide, put_wheels
from tools.programs import ROOT, MissingPartError
from tools.textmate import textmate_grammar

MARK = "playground.json"
"""The list of what Python loads; a folder with this file is a playground and may be overwritten."""


def build(folder: Path) -> None:
    """Write the whole page, or raise MissingPartError and leave the folder unchanged."""
    if folder.exists() and any(folder.iterdir()) and not (folder / MARK).is_file():
        raise MissingPartError(f"{folder} contains other files: choose an empty folder")
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".playground-") as temporary:
        page, npm = Path(temporary, "page"), Path(temporary, "npm")
        npm.mkdir()
        shutil.copytree(HERE / "page", page)
        put_pyodide(page / "pyodide", npm)
        (page / "python").mkdir()
        wheels = put_wheels(page / "python")
        put_libraries(page / "python" / "libraries.zip")
        shutil.copy(HERE / "questions.py", page / "python")
        (page / "words.json").write_text(textmate_grammar(), "utf-8")
        books = [{"name": book.name, "title": book.title} for book in rulec.list()]
        begin = {"samples": samples(), "rulebooks": books}
        (page / "samples.json").write_text(json.dumps(begin, ensure_ascii=False), "utf-8")
        (page / MARK).write_text(json.dumps({"wheels": wheels}), "utf-8")
        shutil.copy(ROOT / "LICENSE", page)
        if folder.exists():
            folder.rename(Path(temporary, "before"))
        page.rename(folder)


def samples() -> list[dict[str, str]]:
    """The page's samples: the rulebooks of the README, the tutorial and a how-to.

    Each has traces to judge, a rulebook to compare with, and as JSON the ``others`` that it
    extends.
    """
    (quiet_lane,) = _blocks("README.md", "rulec")
    mistaken, *_ = _blocks("docs/tutorial.md", "rulec file")
    (atlantis,) = _blocks("docs/tutorial.md", "rulec untidy")
    (drives,) = _blocks("docs/tutorial.md", "json")
    paper = (ROOT / "docs/samples/traces.jsonl").read_text("utf-8")
    yard, depot, north = _blocks("docs/own_rulebooks.md", "rulec file")
    ride = '{"objects": {}, "states": [{"speed": 4}, {"speed": 8}]}\n'
    one_file = [
        {"title": title, "source": source, "traces": traces, "against": against, "others": "[]"}
        for title, source, traces, against in (
            ("A first rule", quiet_lane, paper, "esterle2019"),
            ("A country: Atlantis", rulec.format(atlantis), drives, "vienna"),
            ("Atlantis, with a mistake", mistaken, drives, "vienna"),
        )
    ]
    several = {
        "title": "Three files: words, a depot, and one upon it",
        "source": north,
        "traces": ride,
        "against": "depot.rules",
        "others": json.dumps([yard, depot]),
    }
    return [*one_file, several]


def _blocks(page: str, kind: str) -> list[str]:
    text = (ROOT / page).read_text("utf-8")
    return re.findall(rf"^```{kind}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def main() -> int:
    """Build the playground and print its path."""
    parser = argparse.ArgumentParser(prog="python -m tools.playground", description=build.__doc__)
    parser.add_argument("-o", "--output", type=Path, required=True, help="the folder to write")
    folder = parser.parse_args().output.absolute()
    try:
        build(folder)
    except MissingPartError as error:
        print(f"playground: {error}", file=sys.stderr)
        return 2
    print(f"wrote {folder}; to see it: python -m http.server -d {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
