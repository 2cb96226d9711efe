"""The ledger of verdicts: what a checkout says of all that is at hand, as sorted rows.

``python tests/regression/ledger.py traces FOLDER`` writes the traces to judge: the examples of all
books, the cases of their law, 10,000 random ones with values unknown, names untold and cut ends.
``... record CHECKOUT TRACES FOLDER [BOOK ...]`` judges these, and every recording (those that ship,
and those beside them), by a checkout's ``rulec verify --json``; it writes a file of
rows for each source and book, and ``ledger.tsv`` with their digests. ``... diff FOLDER FOLDER``
shows the rows that differ. ``... digests FOLDER`` writes the digests of sources that ship to
``tests/regression/ledger.tsv``, which the tests hold.

A change that is to change no verdict is recorded before and after it. A row names source, book,
trace, rule, binding, outcome, step, reasons and what the outcome depends on.
Exit status: 0 when all is the same, 1 when something differs, 2 for wrong arguments.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
CHECKOUT = HERE.parents[1]
sys.path[:0] = [str(CHECKOUT / "tests"), str(HERE)]

from support.builders.recorded_data import DATA  # noqa: E402

DIGESTS = HERE / "ledger.tsv"
HEADER = "source\tbook\trows\tviolated\topen\tnot judged\trefused\tdigest\n"
RECORDED = (
    *(".xml", ".fcd.xml.gz", ".pb", ".osi", ".mcap", ".pkl", ".tfrecord", ".parquet", ".feather"),
    ".csv",
)
MAPS = (".net.xml", ".rou.xml")
TIMEOUT_S = 3600


@dataclass(frozen=True)
class Source:
    """A file to judge: its name in the ledger, its path, and the arguments that it needs."""

    name: str
    path: Path
    arguments: tuple[str, ...] = ()


def shipped_recordings(checkout: Path = CHECKOUT) -> list[Source]:
    """The recordings of documentation and tests."""
    files = [*(checkout / "docs/samples").iterdir(), *(checkout / "tests/worlds/stored").iterdir()]
    return _sources(files, checkout)


def shared_recordings() -> list[Source]:
    """The recordings at hand that do not ship."""
    return _sources(DATA.rglob("*"), DATA)


def _sources(files: Iterable[Path], root: Path) -> list[Source]:
    return [
        Source(str(path.relative_to(root)), path, _with_map(path))
        for path in sorted(files)
        if path.name.endswith(RECORDED) and not path.name.endswith(MAPS)
    ]


def _with_map(path: Path) -> tuple[str, ...]:
    """SUMO's positions need a net, which lies beside them; so does OSI's map, if one does."""
    nets = [path.with_name(path.name.split(".")[0] + ending) for ending in (".net.xml", ".xodr")]
    return next((("--map", str(net)) for net in nets if net.is_file()), ())


def traces(folder: Path) -> list[Source]:
    """The files of traces in a folder, each of which is judged by the book of its name."""
    return [Source(path.name, path) for path in sorted(folder.glob("*.jsonl"))]


def rows(checkout: Path, source: Source, books: Sequence[str]) -> dict[str, list[str]]:
    """What a checkout says of a source, by book, as sorted rows.

    Whatever is refused as a whole is a row as well, with the message.
    """
    chosen = [part for book in books for part in ("-r", book)]
    call = [checkout / "rulec", "verify", source.path, *chosen, *source.arguments, "--json"]
    done = subprocess.run(
        call,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        errors="replace",
        env={**os.environ, "NO_COLOR": "1"},
    )
    found: dict[str, list[str]] = {book: [] for book in books}
    for line in done.stdout.splitlines():
        verdict = json.loads(line)
        book, trace = verdict["rulebook"], str(verdict.get("trace", verdict.get("ego", "")))
        found[book] += ("\t".join((trace, *row)) for row in _verdict_rows(verdict))
    if not done.stdout:
        refused = "\t".join(("", "", "", "refused", "", _first_line(done.stderr), ""))
        found = {book: [refused] for book in books}
    return {book: sorted(found[book]) for book in books}


def _first_line(text: str) -> str:
    return next((line for line in text.splitlines() if line.startswith("error")), text[:200])


def _verdict_rows(verdict: dict[str, Any]) -> Iterator[tuple[str, ...]]:
    """Rule, binding, outcome, step, reasons, dependences."""
    if "error" in verdict:
        yield "", "", "refused", "", f"{verdict['error']['code']} {verdict['error']['message']}", ""
        return
    yield "", "", _outcome(verdict), "", "", _listed(verdict.get("by_default", []))
    for one in verdict.get("violations", []):
        defaults = _listed(one.get("by_default", []))
        yield one["rule"], _binding(one), "violated", str(one["step"]), one["strength"], defaults
    for one in verdict.get("open", []):
        depends = _listed(one.get("depends_on", []))
        yield one["rule"], _binding(one), "open", "", _listed(one.get("because", [])), depends
    for one in verdict.get("not_judged", []):
        yield one["rule"], "", "not judged", "", one.get("why", ""), _listed(one.get("untold", []))


def _outcome(verdict: dict[str, Any]) -> str:
    outcomes = {True: "satisfied", False: "violated", None: "undecided"}
    return outcomes[verdict.get("satisfied")]


def _binding(one: dict[str, Any]) -> str:
    return json.dumps(one["binding"], sort_keys=True) if "binding" in one else ""


def _listed(parts: Iterable[str]) -> str:
    return ", ".join(sorted(map(str, parts)))


def digest_line(source: str, book: str, found: list[str]) -> str:
    """The line of a source and book in the table of digests."""
    outcomes = Counter(row.split("\t")[3] for row in found if row.split("\t")[1])
    refused = sum(row.split("\t")[3] == "refused" for row in found)
    digest = hashlib.sha256("\n".join(found).encode()).hexdigest()[:16]
    counts = (len(found), outcomes["violated"], outcomes["open"], outcomes["not judged"], refused)
    return "\t".join((source, book, *map(str, counts), digest))


def record(checkout: Path, trace_folder: Path, folder: Path, books: Sequence[str]) -> int:
    """Write the rows of all sources by the books, and their digests."""
    recordings = [*shipped_recordings(), *shared_recordings()]
    jobs = [(source, [source.name.split(".")[0]]) for source in traces(trace_folder)]
    jobs = [job for job in jobs if job[1][0] in books] + [(one, list(books)) for one in recordings]

    def judged(job: tuple[Source, list[str]]) -> list[str]:
        source, by = job
        lines = []
        for book, found in rows(checkout, source, by).items():
            target = folder / source.name / f"{book}.tsv"
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text("\n".join(found) + "\n", encoding="utf-8")
            lines.append(digest_line(source.name, book, found))
        return lines

    with ThreadPoolExecutor(int(os.environ.get("RULEC_JOBS", "2"))) as pool:
        lines = sorted(line for group in pool.map(judged, jobs) for line in group)
    (folder / "ledger.tsv").write_text(HEADER + "\n".join(lines) + "\n", encoding="utf-8")
    return 0


def differences(before: Path, after: Path) -> dict[str, list[str]]:
    """The rows that stand in one folder only, by file, with ``-`` or ``+`` before them."""
    found = defaultdict(list)
    names = {path.relative_to(root) for root in (before, after) for path in root.rglob("*/*.tsv")}
    for name in sorted(names):
        old, new = (
            (root / name).read_text(encoding="utf-8").splitlines()
            if (root / name).is_file()
            else []
            for root in (before, after)
        )
        gone, come = Counter(old) - Counter(new), Counter(new) - Counter(old)
        for sign, several in (("-", gone), ("+", come)):
            found[str(name)] += (f"{sign} {row}" for row in sorted(several.elements()))
    return {name: changed for name, changed in found.items() if changed}


def main(arguments: list[str]) -> int:
    """Write traces, record verdicts, compare what was recorded, or keep its digests."""
    match arguments:
        case ["traces", folder]:
            from ledger_traces import BOOKS, write_traces

            write_traces(Path(folder), BOOKS)
            return 0
        case ["record", checkout, trace_folder, folder, *books]:
            chosen = books or sorted({one.name.split(".")[0] for one in traces(Path(trace_folder))})
            return record(Path(checkout).resolve(), Path(trace_folder), Path(folder), chosen)
        case ["diff", before, after]:
            changed = differences(Path(before), Path(after))
            for name, several in changed.items():
                print(name, *several, sep="\n")
            print(f"{sum(map(len, changed.values()))} rows differ" if changed else "all the same")
            return 1 if changed else 0
        case ["digests", folder]:
            ships = {one.name for one in shipped_recordings()}
            lines = (Path(folder) / "ledger.tsv").read_text(encoding="utf-8").splitlines()[1:]
            kept = [one for one in lines if one.split("\t")[0] in ships or ".jsonl\t" in one]
            DIGESTS.write_text(HEADER + "\n".join(kept) + "\n", encoding="utf-8")
            return 0
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
