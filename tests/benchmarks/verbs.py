"""How long commands take on every shipped rulebook, called for the first time and once more.

Whole processes: processor time, theirs and that of the processes that they start. The first call of
each begins with an empty cache; the second finds what the first has left there, and nothing has
changed. Of `analyze` and `diff --all`, which take minutes at first, a small book and two are asked.
"""

from __future__ import annotations

import os
import statistics
import subprocess
from collections import defaultdict
from collections.abc import Iterator, Sequence
from tempfile import TemporaryDirectory

from figure import Figure, Result
from program import run
from starting import ROOT, RULEC
from timing import children_ms

import rulec
from rulec.rulebook.files.search_path import available_rulebooks, find_rulebook

MOST_MS = 1000
RECORDING = ROOT / "docs" / "samples" / "following.xml"
VERBS = {
    "check": "check {book}",
    "fmt": "fmt --check {file}",
    "test": "test {book}",
    "show": "show {book}",
    "tree": "show --tree {book}",
    "audit": "show --audit {book}",
    "doc": "doc {book}",
    "diff": "diff {book} {other}",
    "verify": "verify {recording} -r {book}",
    "monitor": "monitor {book}",
    "find": "find true {recording} -r {book}",
    "compile": "compile {book} -o {folder}/out",
    "to C": "compile {book} --emit c -o {folder}/out",
    "to LTL": "compile {book} --emit ltl -o {folder}/out",
}
ONCE = {
    "analyze esterle2019": "analyze esterle2019",
    "diff --all be nl": "diff --all be nl",
}
STATE = b'{"state": {}}\n'
ANSWERED = (0, 1)
"""A drive may violate a rule, and two rulebooks differ."""


CALLS = ("first call", "again")
Calls = tuple[list[float], list[float]]
"""Milliseconds of the first call and of the second, as many as there are rounds."""


def taken(arguments: Sequence[str], rounds: int) -> Calls:
    """What two calls take, the first with an empty cache; in so many rounds."""
    calls: Calls = ([], [])
    for _ in range(rounds):
        with TemporaryDirectory() as folder:
            command = [*RULEC, *(one.format(folder=folder) for one in arguments)]
            environment = {**os.environ, "RULEC_CACHE_DIR": f"{folder}/cache"}
            # Where somebody keeps Python from writing bytecode, every process would compile anew.
            environment.pop("PYTHONDONTWRITEBYTECODE", None)
            for times in calls:
                times.append(call_ms(command, environment))
    return calls


def call_ms(command: Sequence[str], environment: dict[str, str]) -> float:
    """Milliseconds of processor time of a process, which may read a state."""
    before = children_ms()
    done = subprocess.run(command, env=environment, input=STATE, capture_output=True, check=False)
    if done.returncode not in ANSWERED:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.decode()}")
    return children_ms() - before


def of_book(verb: str, book: str) -> list[str]:
    """A command on a shipped rulebook; the folder of what it writes is still open."""
    parts = {
        "book": book,
        "file": find_rulebook(book, ()),
        "other": "de" if book == "vienna" else "vienna",
        "recording": RECORDING,
        "folder": "{folder}",
    }
    return [part.format(**parts) for part in VERBS[verb].split()]


def measure(rounds: int) -> Iterator[Result]:
    """Every verb on every book."""
    # What only declares, such as schemas, has nothing to be compiled to C.
    books = [book for book in available_rulebooks(()) if rulec.compile_rulebook(book).rules]
    found: dict[str, dict[str, Calls]] = defaultdict(dict)
    for book in books:
        for verb in VERBS:
            found[verb][book] = taken(of_book(verb, book), rounds)
    figures = [slowest(verb, n, by_book) for verb, by_book in found.items() for n in (0, 1)]
    for name, command in ONCE.items():
        calls = taken(command.split(), rounds)
        figures += [figure_of(f"{name}, {CALLS[n]}", calls[n]) for n in (0, 1)]
    yield Result(
        "Verbs",
        f"each on the {len(books)} rulebooks that ship, here the slowest of them; first with an "
        "empty cache, then again",
        figures,
        ["Below: milliseconds of the first call, and of the second."],
        table(books, found),
    )


def slowest(verb: str, call: int, by_book: dict[str, Calls]) -> Figure:
    """The figure of the book that takes longest."""
    book = max(by_book, key=lambda one: statistics.median(by_book[one][call]))
    return figure_of(f"{verb}, {CALLS[call]}: {book}", by_book[book][call])


def figure_of(what: str, times: list[float]) -> Figure:
    """Times as a figure; what is asked again is to take less than a second."""
    return Figure(what, "ms", statistics.median(times), min(times), MOST_MS)


def table(books: Sequence[str], found: dict[str, dict[str, Calls]]) -> list[list[str]]:
    """A row for each book, a column for each verb."""
    rows = [[book, *(cell(by_book[book]) for by_book in found.values())] for book in books]
    return [["", *found], *rows]


def cell(calls: Calls) -> str:
    """Both calls, in milliseconds."""
    return "/".join(f"{statistics.median(times):,.0f}" for times in calls)


if __name__ == "__main__":
    run(measure, rounds=1)
