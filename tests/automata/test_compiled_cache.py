"""Compiled rulebooks are recalled while nothing has changed, and only then."""

import os
import pickle
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction

import pytest

import rulec
from rulec import pipeline
from rulec.api import rulebook_compilation
from rulec.api.rulebook_compilation import machines
from rulec.automata import compiled_cache, compiler, prefix_machines
from rulec.cache.cache_folder import cache_folder
from rulec.cache.kept_bytes import KeptBytes
from rulec.cache.row_tables import RowTables, TableWriter
from rulec.diagnostics import RulecError
from rulec.rulebook.reading import reading_cache
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from support.builders.rulebook_projects import project_in

WORDS = "vocabulary words {\n  signal p, q \n}\n"
BASE = "rulebook base\nuse words\nhard rule first { require always (q implies once p) }\n"
BOOK = """\
rulebook book
extends base
hard rule second {
    require always (p implies eventually[<= 1 s] q)
    accept { p and not q; not p and q }
    reject "in time" { p and not q; not p and q }
}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    return project_in(tmp_path, monkeypatch, words=WORDS, base=BASE, book=BOOK)


@pytest.fixture
def made(monkeypatch):
    """The rulebooks that have been compiled anew."""
    names = []

    def noting(file):
        names.append(file.source.name)
        return original(file)

    original = pipeline.parse_all
    monkeypatch.setattr(pipeline, "parse_all", noting)
    return names


class _NoWorker:
    """Lets no process of Spot start, except where it is allowed."""

    def __init__(self, monkeypatch):
        self._monkeypatch = monkeypatch
        self._forbid()

    def _forbid(self):
        self._monkeypatch.setattr(compiler, "_worker", _refuse)

    @contextmanager
    def allowed(self):
        self._monkeypatch.setattr(compiler, "_worker", _WORKER)
        yield
        self._forbid()


_WORKER = compiler._worker


def _refuse(**_):
    raise AssertionError("it has been compiled before")


@pytest.fixture
def no_worker(monkeypatch):
    monkeypatch.setattr(prefix_machines, "_KNOWN", {})
    return _NoWorker(monkeypatch)


def kept():
    return sorted(cache_folder().glob("*.tables"))


def compiled(reference="book.rules", **more):
    return machines(reference, **more)


def test_what_is_recalled_is_what_was_compiled(folder, made):
    told = []
    fresh = pipeline.compile_source("book.rules", on_warning=told.append)
    first, again = compiled(warn=told.append), compiled(warn=told.append)
    assert fresh == first == again
    assert [axiom.place for axiom in fresh.axioms] == [axiom.place for axiom in again.axioms]
    assert made == ["book.rules", "book.rules"]
    assert list(told[0]) == list(told[1]) == list(told[2])
    assert [one.code for one in told[2]] == ["R0406"]


def test_another_step_is_compiled_once(folder, no_worker):
    step = Fraction(1, 10)
    with no_worker.allowed():
        fresh = compiled().at_step(step)
        cut = fresh.prefixes(fresh)
    again = compiled().at_step(step)
    assert again == fresh
    assert again.at_step(step) is again
    recalled = again.prefixes(again)
    assert {name: table(machine) for name, machine in recalled.items()} == {
        name: table(machine) for name, machine in cut.items()
    }
    assert all(machine.order is not None for machine in recalled.values())
    assert [machine.above for machine in recalled.values()] == [
        machine.above for machine in cut.values()
    ]
    # One rule asks what was before the first state.
    assert max(len(machine.starts) for machine in recalled.values()) > 1


def test_what_another_step_has_alike_is_there_once(folder):
    compiled().at_step(Fraction(1, 10))
    own = compiled()
    first, second = zip(own.rules, own.at_step(Fraction(1, 10)).rules, strict=True)
    assert first[0] is first[1]
    assert second[0] != second[1]
    assert own.at_step(Fraction(1, 10)).vocabulary is own.vocabulary
    beside, alone = sorted(path.stat().st_size for path in kept())
    assert beside < alone


def test_rules_with_the_same_tables_read_what_they_read(folder):
    (folder / "alike.rules").write_text(
        "rulebook alike\nuse words\n"
        "hard rule first { require always p }\nhard rule second { require always q }\n"
    )
    compiled("alike.rules").prefixes(compiled("alike.rules"))
    book = compiled("alike.rules")
    machines_of = book.prefixes(book)
    assert [machine.reads[0].name for machine in machines_of.values()] == ["p", "q"]


def table(machine):
    return machine.reads, machine.letters, rows(machine.successors), rows(machine.outputs)


def rows(table):
    return [list(row) for row in table]


@pytest.mark.parametrize("name", ["book", "base", "words"])
def test_a_change_anywhere_counts(folder, made, name):
    compiled().at_step(0.5)
    path = folder / f"{name}.rules"
    path.write_text(f"{path.read_text()}# more\n")
    assert compiled().sources != ()
    assert compiled().at_step(0.5).sources == compiled().sources
    assert made == ["book.rules", "book.rules"]
    assert compiled() == machines("book.rules")


def test_a_file_that_comes_before_another_counts(folder, made):
    compiled()
    (folder / "vocabulary").mkdir()
    (folder / "words.rules").rename(folder / "vocabulary" / "words.rules")
    compiled()
    compiled()
    assert len(made) == 2


def test_the_day_counts_where_the_rulebook_says_none(folder, made, monkeypatch):
    compiled()
    monkeypatch.setattr(reading_cache, "_today", lambda: "2020-01-01")
    compiled()
    assert len(made) == 2
    monkeypatch.setattr(reading_cache, "_today", lambda: "2020-01-02")
    compiled(at="2020-01-01")
    monkeypatch.setattr(reading_cache, "_today", lambda: "2020-01-03")
    compiled(at="2020-01-01")
    assert len(made) == 3


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.write_bytes(b""),
        lambda path: path.write_bytes(path.read_bytes()[:-9]),
        lambda path: path.write_bytes(path.read_bytes()[:20]),
        lambda path: path.write_bytes(path.read_bytes()[::-1]),
        lambda path: path.write_bytes(TableWriter().file(b"{}")),
        lambda path: path.write_bytes(TableWriter().file(b"\xff")),
    ],
)
def test_a_damaged_file_is_made_anew(folder, made, damage):
    first = compiled()
    (path,) = kept()
    damage(path)
    assert compiled() == first
    assert compiled() == first
    assert len(made) == 2


def test_what_somebody_else_has_written_is_not_trusted(folder, made, monkeypatch):
    first = compiled()
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    assert compiled() == first
    assert len(made) == 2


def test_what_others_may_write_to_is_not_trusted(folder, made):
    compiled()
    (path,) = kept()
    path.chmod(0o660)
    compiled()
    assert len(made) == 2
    cache_folder().chmod(0o770)
    compiled()
    compiled()
    assert len(made) == 4


def test_without_a_folder_to_write_to_it_is_compiled_each_time(folder, made, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "file" / "cache"))
    assert compiled() == compiled()
    assert len(made) == 2


def test_few_files_are_kept(folder, monkeypatch):
    few = replace(compiled_cache._COMPILED, files=KeptBytes("tables", 3, always=True))
    monkeypatch.setattr(compiled_cache, "_COMPILED", few)
    book = compiled()
    for number, step in enumerate((1, 0.5, 0.25, 0.125)):
        for path in kept():
            os.utime(path, (number, number))
        book.recompile(Fraction(step))
    assert 1 <= len(kept()) <= 3


def test_a_pickled_one_still_asks_the_cache(folder, no_worker):
    with no_worker.allowed():
        compiled().at_step(0.5)
    book = pickle.loads(pickle.dumps(compiled()))
    assert book.at_step(0.5) == compiled().at_step(0.5)


def test_a_row_is_what_was_placed():
    tables = TableWriter()
    written = [(1, -1, 0), (), (1 << 40, -(1 << 40)), (127, 128), (1, -1, 0)]
    places = [tables.place(row) for row in written]
    assert places[0] == places[-1]
    read = RowTables(tables.file(b"text"))
    assert read.text == b"text"
    assert [read.row(place) for place in places] == written
    assert read.rows(places[2], 1) == ((1 << 40,), (-(1 << 40),))
    with pytest.raises(ValueError, match="width"):
        read.rows(places[0], 2)
    with pytest.raises(ValueError, match="cut off"):
        read.row(("q", 8, 1000))
    with pytest.raises(ValueError, match="no place"):
        read.row(("b", -1, 1))


def test_every_bit_of_a_file_counts(folder):
    kept_bytes, data = KeptBytes("bits", 1, always=True), TableWriter().file(b"text")
    kept_bytes.keep({"key": data})
    assert kept_bytes.recall("key") == data
    (path,) = cache_folder().glob("*.bits")
    written = path.read_bytes()
    for number in range(8 * len(written)):
        changed = bytearray(written)
        changed[number // 8] ^= 1 << number % 8
        path.write_bytes(bytes(changed))
        assert kept_bytes.recall("key") is None


STEPS = [None, 0.5, Fraction(1, 10)]


@pytest.mark.parametrize("step", STEPS, ids=str)
def test_a_program_recalls_what_it_compiled(folder, made, step):
    fresh = rulebook_compilation.compile_rulebook(load_rulebook("book.rules"), step_s=step)
    first, again = (rulec.compile_rulebook("book.rules", step_s=step) for _ in range(2))
    assert fresh == first == again
    assert made == ["book.rules"]
    assert (again.recompile is None) == (fresh.recompile is None)
    assert compiled() == machines("book.rules")


def test_its_source_is_read_again(folder, made):
    compiled()
    again = pickle.loads(pickle.dumps(compiled()))
    assert again.source == rulec.load_rulebook("book.rules")
    assert again.at_step(0.5).source == again.source
    where = again.place_of("second")
    assert (where.file, where.line) == ("book.rules", 3)


def test_without_its_source_a_rule_has_no_place(folder):
    compiled()
    again = compiled()
    (folder / "book.rules").unlink()
    assert again.place_of("second") is None
    with pytest.raises(RulecError) as caught:
        assert again.source
    assert caught.value.diagnostics[0].code in {"R0701", "R0703"}


def test_a_rule_without_examples_has_a_step_that_fits_its_bounds(folder):
    text = "rulebook odd\nuse words\nhard rule odd { require always eventually[<= 0.7 s] p }\n"
    (folder / "odd.rules").write_text(text)
    assert compiled("odd.rules").at_step(0.7)
    for _ in range(2):
        assert rulec.compile_rulebook("odd.rules").rules[0].step_s == Fraction(1, 10)
        assert compiled("odd.rules").at_step(0.7)
