"""Short drives told whole, of which nothing is violated but what the law of the book says.

`statutes/BOOK.toml` has those of a book: what holds throughout, and states a second apart. Sides
are absolute. `asked` has what an examiner would ask, each drive with the books that it asks; so
does `asked_by_book`, which goes through what each book has that nobody had asked yet, and
`asked_in_theory`, on limits, the order of events, exceptions and what comes before what.
"""

from pathlib import Path
from typing import Any

import pytest

from rulec.diagnostics import Source
from rulec.monitoring.batch.batch_verify import verify_many
from rulec.monitoring.verdict import Verdict
from rulec.toml import parsed_toml
from rulec.trace import Trace
from support.builders.national_books import compiled, read


def situations(folder: str) -> list[tuple[str, dict[str, Any]]]:
    """Each situation of a folder's files, with its file's stem."""
    return [
        (path.stem, one)
        for path in sorted((Path(__file__).parent / folder).glob("*.toml"))
        for one in parsed_toml(Source(path.name, path.read_text(encoding="utf-8")), "R0704", "")[
            "situation"
        ]
    ]


def by_book() -> dict[str, dict[str, dict[str, Any]]]:
    """The situations of each book that has some or is asked about some, by file and title."""
    asked = [
        (book, f"{file}: {one['title']}", one)
        for folder in ("asked", "asked_by_book", "asked_in_theory")
        for file, one in situations(folder)
        for book in one.get("books") or one["law"]
    ]
    own = [(book, f"own: {one['title']}", one) for book, one in situations("statutes")]
    found: dict[str, dict[str, dict[str, Any]]] = {}
    for book, title, one in (*own, *asked):
        assert title not in found.setdefault(book, {}), f"two situations of one title: {title}"
        found[book][title] = one
    return found


SITUATIONS = by_book()


def trace_of(situation: dict[str, Any]) -> Trace:
    states = tuple(
        {**situation["throughout"], **state}
        for state in situation["states"] * situation.get("repeated", 1)
    )
    return Trace("t", 1.0, situation.get("objects", {}), states)


@pytest.mark.parametrize("book", SITUATIONS)
def test_drives_violate_what_the_law_says_and_no_more(book: str) -> None:
    verdicts = verify_many(map(trace_of, SITUATIONS[book].values()), compiled(book))
    wrong = {}
    for (title, situation), verdict in zip(SITUATIONS[book].items(), verdicts, strict=True):
        assert isinstance(verdict, Verdict), f"{title}: {verdict}"
        found = {one.rule for one in verdict.violations}
        if found != set(situation["violated"]):
            wrong[title] = f"violates {sorted(found)}, and not {situation['violated']}"
    assert wrong == {}


@pytest.mark.parametrize("book", SITUATIONS)
def test_a_book_has_the_rules_that_are_violated(book: str) -> None:
    violated = {rule for one in SITUATIONS[book].values() for rule in one["violated"]}
    assert violated <= {rule.name for rule in read(book).rulebook.rules}
