"""What rulec says of all that ships is what the ledger's digests say.

Where a change is meant, `ledger.py digests` keeps the new ones, and the change says which rows
differ, and why.
"""

import sys
from functools import cache
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import ledger  # noqa: E402
from ledger_traces import write_traces  # noqa: E402

KEPT = [line.split("\t") for line in ledger.DIGESTS.read_text(encoding="utf-8").splitlines()[1:]]
QUICK = {
    ("esterle2019.known.jsonl", "esterle2019"),
    ("esterle2019.random.jsonl", "esterle2019"),
    ("nl.random.jsonl", "nl"),
    ("docs/samples/following.xml", "de"),
    ("docs/samples/passing.fcd.xml", "gb"),
}


@cache
def recordings():
    return {one.name: one for one in ledger.shipped_recordings()}


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The traces of a book, written once."""
    folder, done = tmp_path_factory.mktemp("traces"), set()

    def of(book):
        if book not in done:
            done.add(book)
            write_traces(folder, (book,))
        return {one.name: one for one in ledger.traces(folder)}

    return of


def test_the_quick_ones_are_kept():
    assert {(source, book) for source, book, *_ in KEPT} > QUICK


@pytest.mark.parametrize(
    "line",
    [
        pytest.param(
            line,
            id="-".join(line[:2]),
            marks=[] if tuple(line[:2]) in QUICK else pytest.mark.long,
        )
        for line in KEPT
    ],
)
def test_nothing_has_changed(line, written):
    name, book = line[:2]
    source = recordings().get(name) or written(book)[name]
    (found,) = ledger.rows(ledger.CHECKOUT, source, [book]).values()
    assert ledger.digest_line(name, book, found).split("\t") == line
