"""Compare what two checkouts of rulec answer: tables, counts, verdicts, texts.

``python tests/regression/compare.py record CHECKOUT FOLDER`` writes every answer of a checkout to
a file below FOLDER; ``... diff FOLDER FOLDER`` compares two such folders. A refactoring that is to
change nothing is recorded before and after. ``RULEC_RECORDINGS`` names a folder of recordings.
Exit status: 0 when all is the same, 1 when something differs, 2 for wrong arguments.
"""

from __future__ import annotations

import hashlib
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path

PROCESSES = 2
TIMEOUT_S = 900
# What differs from run to run: how long an answer took, and where the checkout lies.
VOLATILE = [
    (re.compile(r'"(?:seconds|computed_s|wall_s|duration_s)": ?[0-9.e-]+'), '"seconds": 0'),
    (re.compile(r"computed in [0-9.]+ s"), "computed in 0 s"),
    # Worded anew on purpose.
    (re.compile("beyond saving"), "cannot be kept any more"),
    # JSON has a version since the schemas are published.
    (re.compile(r'"version": 1,\s*'), ""),
]


def jobs(checkout: Path) -> dict[str, list[str]]:
    """Arguments of every call, by the name of the file that its answer is written to."""
    books = sorted(
        path.stem
        for path in (checkout / "rulebooks").glob("*/*.rules")
        if path.stem == path.parent.name
    )
    calls: dict[str, list[str]] = {}
    for book in books:
        calls[f"compile/{book}"] = ["compile", book, "-o", "{out}"]
        calls[f"doc/{book}"] = ["doc", book, "-o", "{out}.md", "--format", "markdown"]
        calls[f"test/{book}"] = ["test", book, "--output-format", "json", "--coverage"]
        calls[f"test-text/{book}"] = ["test", book, "--coverage"]
        calls[f"audit/{book}"] = ["audit", book, "--output-format", "json"]
        calls[f"tree/{book}"] = ["tree", book, "--json"]
        calls[f"check/{book}"] = ["check", book, "--no-cache"]
    for book in ("de", "vienna", "esterle2019"):
        calls[f"compile-0.1/{book}"] = ["compile", book, "--step", "1/10", "-o", "{out}"]
        calls[f"show/{book}"] = ["show", book, "--json"]
        calls[f"show-text/{book}"] = ["show", book]
        calls[f"analyze/{book}"] = ["analyze", book, "--output-format", "json"]
    for left, right in (("de", "nl"), ("gb", "vienna"), ("us-ca", "de")):
        calls[f"diff/{left}-{right}"] = ["diff", left, right, "--output-format", "json"]
        calls[f"diff-text/{left}-{right}"] = ["diff", left, right]
    for scene, step, adjacency, book in product(
        ("s1", "s2", "s3"), ("1", "0.5"), ("touch", "edge", "forward"), ("esterle2019", "vienna")
    ):
        calls[f"maneuvers/{scene}-{step}-{adjacency}-{book}"] = [
            *("maneuvers", scene, "--step", step, "--adjacency", adjacency, "-r", book),
            *("--json", "--list", "5", "--rank", "3", "--why", "--classes", "3"),
        ]
    for scene in ("s1", "s2", "s3"):
        calls[f"traces/{scene}"] = ["traces", scene, "-r", "esterle2019", "-o", "-"]
        calls[f"draw/{scene}"] = ["draw", "scene", scene, "-o", "{out}.svg"]
        calls[f"draw-graph/{scene}"] = [
            "draw",
            "graph",
            scene,
            "-r",
            "esterle2019",
            "-o",
            "{out}.svg",
        ]
    sample = "docs/samples/traces.jsonl"
    calls["verify/text"] = ["verify", sample, "-r", "esterle2019", "--explain", "3"]
    calls["verify/json"] = ["verify", sample, "-r", "esterle2019", "--explain", "3", "--json"]
    calls["explain/all"] = ["explain", "--all"]
    calls["list/rulebooks"] = ["list", "rulebooks", "--json"]
    calls["help/top"] = ["--help"]
    for verb in (
        *("analyze", "audit", "check", "compile", "completion", "diff", "doc", "draw", "envelopes"),
        *("explain", "fmt", "list", "maneuvers", "monitor", "new", "show", "test", "traces"),
        *("tree", "verify"),
    ):
        calls[f"help/{verb}"] = [verb, "--help"]
    recordings = os.environ.get("RULEC_RECORDINGS")
    if recordings:
        files = sorted(
            path
            for path in Path(recordings).rglob("*.xml*")
            if path.suffixes[-2:] in ([".xml"], [".xml", ".gz"]) or path.suffix == ".xml"
            if not path.name.endswith((".net.xml", ".rou.xml"))
        )
        for path in files:
            calls[f"recording/{path.stem}-de"] = ["verify", str(path), "-r", "de", "--json"]
            calls[f"recording-text/{path.stem}-gb"] = ["verify", str(path), "-r", "gb"]
            calls[f"recording-maneuvers/{path.stem}"] = [
                "maneuvers",
                str(path),
                "-r",
                "de",
                "--json",
            ]
        for path in files[:4]:
            calls[f"recorded-traces/{path.stem}"] = [
                *("traces", str(path), "--recorded", "-r", "de", "-o", "-"),
            ]
    return calls


def settled(text: str) -> str:
    """Leave out what differs from run to run, or on purpose."""
    for pattern, instead in VOLATILE:
        text = pattern.sub(instead, text)
    return text


def answer(checkout: Path, folder: Path, name: str, arguments: list[str]) -> None:
    """Run one call and write its status and streams, and digests of the files it made."""
    target = folder / name
    target.parent.mkdir(parents=True, exist_ok=True)
    out = target.with_name(f"{target.name}.made")
    call = [str(checkout / "rulec"), *(part.replace("{out}", str(out)) for part in arguments)]
    done = subprocess.run(
        call, cwd=checkout, capture_output=True, text=True, timeout=TIMEOUT_S, errors="replace"
    )
    streams = f"status {done.returncode}\n{done.stdout}\n-- standard error\n{done.stderr}"
    settled_streams = settled(streams.replace(str(checkout), "CHECKOUT"))
    target.write_text(settled_streams.replace(str(folder), "FOLDER"))
    for path in sorted(out.rglob("*")) if out.is_dir() else []:
        print(f"{hashlib.sha256(path.read_bytes()).hexdigest()[:16]} {path.relative_to(folder)}")


def record(checkout: Path, folder: Path) -> int:
    """Write all answers of a checkout below a folder."""
    with ThreadPoolExecutor(PROCESSES) as pool:
        list(pool.map(lambda job: answer(checkout, folder, *job), jobs(checkout).items()))
    return 0


def differences(before: Path, after: Path) -> list[str]:
    """The files that stand in one folder only, or differ."""
    names = {
        path.relative_to(folder)
        for folder in (before, after)
        for path in folder.rglob("*")
        if path.is_file()
    }
    return [
        str(name)
        for name in sorted(names)
        if not ((before / name).is_file() and (after / name).is_file())
        or not _same((before / name).read_bytes(), (after / name).read_bytes())
    ]


def _same(before: bytes, after: bytes) -> bool:
    if before == after:
        return True
    return settled(before.decode(errors="replace")) == settled(after.decode(errors="replace"))


def main(arguments: list[str]) -> int:
    """Record the answers of a checkout, or compare two recorded folders."""
    match arguments:
        case ["record", checkout, folder]:
            return record(Path(checkout).resolve(), Path(folder).resolve())
        case ["diff", before, after]:
            different = differences(Path(before), Path(after))
            print("\n".join(different) or "all the same")
            return 1 if different else 0
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
