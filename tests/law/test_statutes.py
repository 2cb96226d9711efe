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
from rulec.monitoring.verify import verify
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


SITUATIONS = [
    pytest.param(book, one, id=f"{book}-{one['title']}") for book, one in situations("statutes")
]
ASKED = [
    pytest.param(one, id=f"{file}-{one['title']}")
    for folder in ("asked", "asked_by_book", "asked_in_theory")
    for file, one in situations(folder)
]


def violated(book: str, situation: dict[str, Any]) -> set[str]:
    states = tuple(
        {**situation["throughout"], **state}
        for state in situation["states"] * situation.get("repeated", 1)
    )
    trace = Trace("t", 1.0, situation.get("objects", {}), states)
    return {one.rule for one in verify(trace, compiled(book)).violations}


def has_rules(book: str, names: list[str]) -> bool:
    return set(names) <= {rule.name for rule in read(book).rulebook.rules}


@pytest.mark.parametrize(("book", "situation"), SITUATIONS)
def test_a_drive_violates_what_the_law_says_and_no_more(
    book: str, situation: dict[str, Any]
) -> None:
    assert violated(book, situation) == set(situation["violated"])
    assert has_rules(book, situation["violated"])


@pytest.mark.parametrize("situation", ASKED)
def test_what_is_asked_of_several_books(situation: dict[str, Any]) -> None:
    books = situation.get("books") or list(situation["law"])
    found = {book: violated(book, situation) for book in books}
    assert found == {book: set(situation["violated"]) for book in books}
    assert all(has_rules(book, situation["violated"]) for book in books)
