"""A rulebook from the cache is what reading gives, and is taken only while nothing has changed."""

import os
import subprocess
import sys
from datetime import date

import pytest

from rulec.cache import kept_bytes
from rulec.cache.cache_folder import cache_folder
from rulec.cache.keeping import keeping
from rulec.cache.row_tables import RowTables, TableWriter
from rulec.cache.stored_objects import DAMAGED, ObjectCodec, kinds_of_fields
from rulec.diagnostics import RulecError, SourceLocation
from rulec.rulebook import loader
from rulec.rulebook.batch import batch_check
from rulec.rulebook.reading import reading_cache
from rulec.rulebook.reading.rulebook_cache import RULE_KINDS
from rulec.rulebook.reading.rulebook_reader import read_rulebook
from support.builders.rulebook_projects import project_in

WORDS = "vocabulary words {\n  signal p, q \n}\n"
BASE = "rulebook base\nuse words\nparam most: time = 1 s\nhard rule first { require always p }\n"
BOOK = """\
rulebook book
extends base
hard rule second {
    require always (p implies eventually[<= most] q)
    accept { p and not q; not p and q }
}
hard rule third { require never p then q }
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    return project_in(tmp_path, monkeypatch, words=WORDS, base=BASE, book=BOOK)


@pytest.fixture
def resolved(monkeypatch):
    """How often a rulebook has been resolved."""
    times = []

    def counting(*arguments):
        times.append(arguments)
        return original(*arguments)

    original = loader.resolve_trees
    monkeypatch.setattr(loader, "resolve_trees", counting)
    return times


def read(reference="./book.rules", **options):
    with keeping():
        return read_rulebook(reference, **options)


def written(loaded):
    """Everything in a rulebook, with the places that are not compared."""
    return ObjectCodec(RULE_KINDS).written(loaded.rulebook)


@pytest.mark.parametrize("name", ["vienna", "de", "gb", "esterle2019"])
def test_what_ships_is_read_back_in_every_detail(folder, resolved, name):
    first, again = read(name), read(name)
    assert len(resolved) == 1
    assert again.rulebook is not first.rulebook
    assert again == first
    assert dict(again.sources) == dict(first.sources)
    assert written(again) == written(first)


def test_warnings_are_part_of_it(folder, resolved):
    first, again = read(), read()
    assert len(resolved) == 1
    assert first.warnings == again.warnings != ()


def test_who_imports_rulec_keeps_nothing(folder, resolved):
    assert read_rulebook("./book.rules") == read_rulebook("./book.rules")
    assert len(resolved) == 2
    assert not cache_folder().exists()


class Tomorrow(date):
    @classmethod
    def today(cls):
        return cls(2030, 1, 1)


def edited(name, old, new):
    def change(folder, _):
        path = folder / f"{name}.rules"
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new))

    return change


def nearer_words(folder, _):
    """The same text, in another place."""
    (folder / "vocabulary").mkdir()
    (folder / "words.rules").rename(folder / "vocabulary" / "words.rules")


CHANGES = {
    "the book": edited("book", "always", "never"),
    "a comment": edited("book", "rulebook book", "# c\nrulebook book"),
    "its parent": edited("base", "1 s", "2 s"),
    "the vocabulary": edited("words", "p, q", "p, q, other"),
    "the vocabulary's place": nearer_words,
    "rulec": lambda _, patch: patch.setattr(kept_bytes, "program_digest", lambda: "0"),
    "the day": lambda _, patch: patch.setattr(reading_cache, "date", Tomorrow),
    "a limit": lambda _, patch: patch.setenv("RULEC_LIMITS", "search=9000000"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_every_change_counts(folder, resolved, monkeypatch, change):
    read()
    CHANGES[change](folder, monkeypatch)
    again = read()
    assert len(resolved) == 2
    assert again == read() == read_rulebook("./book.rules")
    assert len(resolved) == 3, "only the reading without the cache came on top"


def test_each_question_is_kept_by_itself(folder, resolved, monkeypatch):
    options = ({}, {"at": "2020-01-01"}, {"traffic": "left"}, {"search_path": [folder]})
    answers = [read(**option) for option in options]
    assert answers == [read(**option) for option in options]
    assert [one.rulebook.traffic for one in answers] == ["", "", "left", ""]
    assert answers[1].rulebook.at == "2020-01-01" != answers[0].rulebook.at
    assert len(resolved) == 4
    # What messages call it is part of it, too.
    assert [*read(str(folder / "book.rules")).sources][-2:] != [*answers[0].sources][-2:]
    assert len(resolved) == 5


DAMAGES = {
    "empty": lambda path: path.write_bytes(b""),
    "cut": lambda path: path.write_bytes(path.read_bytes()[:-9]),
    "one byte": lambda path: path.write_bytes(path.read_bytes()[:-1] + b"?"),
    "another file's": lambda path: path.write_bytes(
        next(one for one in cache_folder().iterdir() if one.suffix != path.suffix).read_bytes()
    ),
    "gone": lambda path: path.unlink(),
    "a folder": lambda path: (path.unlink(), path.mkdir()),
    "open to others": lambda path: path.chmod(0o666),
    "folder open to others": lambda path: path.parent.chmod(0o770),
}


@pytest.mark.parametrize("kind", ["book", "reading"])
@pytest.mark.parametrize("damage", DAMAGES)
def test_damage_costs_time_only(folder, resolved, kind, damage):
    first = read()
    (path,) = cache_folder().glob(f"*.{kind}")
    DAMAGES[damage](path)
    assert read() == first
    assert len(resolved) == 2


def test_what_somebody_else_has_written_is_not_read(folder, resolved, monkeypatch):
    first = read()
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    assert read() == first
    assert len(resolved) == 2


def test_the_book_of_another_state_of_its_files_is_not_taken(folder, resolved):
    """Even where somebody puts it in the place of the present one."""
    read()
    (old,) = cache_folder().glob("*.book")
    edited("base", "1 s", "2 s")(folder, None)
    second = read()
    (new,) = set(cache_folder().glob("*.book")) - {old}
    new.write_bytes(old.read_bytes())
    assert read() == second
    assert len(resolved) == 3


@pytest.mark.parametrize("item", [SourceLocation("a"), "a", {"a": ()}])
def test_what_is_no_rulebook_is_read_anew(folder, resolved, monkeypatch, item):
    """A file that this rulec wrote, and yet of something else."""
    first = read()
    wrong = ObjectCodec({**RULE_KINDS, **kinds_of_fields((SourceLocation,))}).written((item,))
    recall = kept_bytes.KeptBytes.recall
    monkeypatch.setattr(
        kept_bytes.KeptBytes,
        "recall",
        lambda kept, key: wrong if kept.kind == "book" else recall(kept, key),
    )
    assert read() == first
    assert len(resolved) == 2


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        (b"", []),
        (b"null", []),
        (b"{}", []),
        (b'{"given":0,"made":0,"values":[],"parts":["B",0,0]}', []),
        (b'{"given":0,"made":1,"values":[],"parts":["B",0,0]}', []),
        (b'{"given":0,"made":1e9,"values":[1],"parts":["B",0,3]}', [3, 0, 0]),
        (b'{"given":0,"made":1000000000000,"values":[1],"parts":["B",0,3]}', [3, 0, 0]),
        (b'{"given":0,"made":1,"values":[1],"parts":["B",0,3]}', [3, 200, 0]),
        (b'{"given":0,"made":1,"values":[1],"parts":["B",0,3]}', [3, 0, 9]),
        (b'{"given":0,"made":1,"values":[1,0],"parts":["b",0,4]}', [4, 5, -1, -2]),
        (b'{"given":1,"made":1,"values":[1],"parts":["B",0,3]}', [3, 0, 0]),
        (b"[" * 100_000, []),
    ],
)
def test_parts_that_are_none_are_refused(text, parts):
    tables = TableWriter()
    tables.place(parts)
    with pytest.raises(DAMAGED):
        ObjectCodec(RULE_KINDS).read(RowTables(tables.file(text)))


def test_a_mistake_is_reported_as_without_the_cache(folder):
    edited("book", "always (p", "always (pp")(folder, None)
    with keeping():
        found = batch_check.check(["book.rules"], bytes).findings
    for _ in range(2):
        with pytest.raises(RulecError) as error:
            read()
        assert [one.code for one in error.value.diagnostics] == [one.code for one in found]
    assert [one.code for one in found if one.severity == "error"] == ["R0202"]


def test_a_vocabulary_is_no_rulebook_though_its_check_is_known(folder):
    with keeping():
        assert batch_check.check(["./words.rules"], bytes).findings == ()
    with pytest.raises(RulecError, match="R0206"):
        read("./words.rules")


def test_a_check_and_a_reading_know_the_same(folder, resolved, monkeypatch):
    first = read().warnings
    monkeypatch.setattr(loader, "diagnose", None)
    with keeping():
        assert batch_check.check(["./book.rules"], bytes).findings == first


def test_processes_side_by_side_give_the_same(folder):
    program = (
        "import sys; from rulec.cli.main import main;"
        "sys.exit(main(['show', './book.rules', '--all']))"
    )

    def started():
        return subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE)

    for _ in range(2):
        running = [started() for _ in range(4)]
        said = [process.communicate()[0] for process in running]
        assert {process.returncode for process in running} == {0}
        assert len(set(said)) == 1
        assert b"second" in said[0]
    assert len([*cache_folder().glob("*.book")]) == 1
    assert not [*cache_folder().glob(".*.part")]
