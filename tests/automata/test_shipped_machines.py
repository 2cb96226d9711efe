"""Trees and machines that ship are used where nothing is kept yet, and only if they are current."""

import shutil

import pytest

from rulec.automata import compiler, second_compiler
from rulec.automata.step_compilation import StepCompiler
from rulec.automata.worker import machine_cache
from rulec.cache import shipped_bytes
from rulec.cache.keeping import keeping
from rulec.cache.shipped_bytes import shipped, shipped_key, shipped_text
from rulec.diagnostics import Source
from rulec.resources import rulebooks_folder
from rulec.rulebook.batch import batch_format
from rulec.rulebook.loader import read_rulebook
from rulec.syntax.caching import tree_cache
from rulec.syntax.parser import parse
from support.remembered_machines import ASKED
from support.source_modules import PACKAGE
from tools import shipped_caches

MAKERS = tree_cache.MAKERS
ENTRIES = {shipped_key(str(number)): bytes(range(number)) * number for number in range(50)}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder of shipped files of its own, and no cache of the user's."""
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(shipped_bytes, "rulebooks_folder", lambda: tmp_path)
    shipped.cache_clear()
    yield tmp_path
    shipped.cache_clear()


def written(folder, data, kind="tree"):
    (folder / f"shipped.{kind}").write_bytes(data)
    shipped.cache_clear()
    return shipped(kind, MAKERS)


def test_every_file_that_ships_depends_on_is_there():
    """The digest passes over a file that has moved, and then over its changes."""
    makers = {*tree_cache.MAKERS, *machine_cache.MAKERS} - {"grammar"}  # which stands elsewhere
    assert [name for name in sorted(makers) if not (PACKAGE / name).exists()] == []


def test_what_is_written_is_recalled(folder):
    there = written(folder, shipped_text(ENTRIES, MAKERS))
    assert there.keys == ENTRIES.keys()
    assert all(there.recall(key) == data for key, data in ENTRIES.items())
    assert there.recall(shipped_key("another")) is None


def test_the_same_file_is_written_of_the_same_entries():
    backwards = dict(reversed(ENTRIES.items()))
    assert shipped_text(backwards, MAKERS) == shipped_text(ENTRIES, MAKERS)


def test_nothing_is_used_of_other_code(folder):
    written(folder, shipped_text(ENTRIES, MAKERS))
    assert shipped("tree", ("logic",)).keys == set()


@pytest.mark.parametrize("end", [0, 5, 40, 60, 2000, -1])
def test_nothing_is_used_of_a_file_that_is_cut(folder, end):
    assert written(folder, shipped_text(ENTRIES, MAKERS)[:end]).keys == set()


def test_an_entry_is_as_it_was_written_or_is_not_there(folder):
    data = shipped_text(ENTRIES, MAKERS)
    for place in range(len(data) // 2, len(data), 97):
        changed = bytearray(data)
        changed[place] ^= 0x10
        there = written(folder, bytes(changed))
        for key in there.keys & ENTRIES.keys():
            assert there.recall(key) in (ENTRIES[key], None)


def test_a_shipped_text_is_not_parsed(folder, monkeypatch):
    text = (shipped_caches.rulebooks_folder() / "esterle2019" / "esterle2019.rules").read_text()
    shutil.copy(rulebooks_folder() / "shipped.tree", folder)
    source = Source("a.rules", text)
    monkeypatch.setattr(tree_cache, "parse", None)
    assert tree_cache.parsed(source) == parse(source)
    with keeping():
        file, mistakes = tree_cache.parsed(source)
        assert (file, mistakes) == parse(source)
        with pytest.raises(TypeError):
            tree_cache.parsed(Source("a.rules", text + "\n"))
    with keeping(on=False), pytest.raises(TypeError):
        tree_cache.parsed(source)
    assert not (folder / "cache").exists()


def test_a_shipped_text_is_in_form_and_no_other(folder, monkeypatch):
    path = rulebooks_folder() / "esterle2019" / "esterle2019.rules"
    shutil.copy(rulebooks_folder() / "shipped.tree", folder)
    other = folder / "other.rules"
    other.write_text("  " + path.read_text())
    with keeping():
        monkeypatch.setattr(batch_format, "formatted", lambda *_: 1 / 0)
        (file,) = batch_format.format_files([str(path)], recalls=True).files
        assert not file.changed
        with pytest.raises(ZeroDivisionError):
            batch_format.format_files([str(path)])
        with pytest.raises(ZeroDivisionError):
            batch_format.format_files([str(other)], recalls=True)


@pytest.mark.spot
def test_a_shipped_rulebook_is_not_compiled(folder, monkeypatch):
    shutil.copy(rulebooks_folder() / "shipped.machine", folder)
    rulebook = read_rulebook("esterle2019").rulebook
    monkeypatch.setattr(compiler, "answers_to", ASKED)
    with keeping(on=False):
        fresh = StepCompiler(rulebook).at_own_steps()
    monkeypatch.setattr(compiler, "_worker", None)
    # Who imports rulec keeps nothing, but has what ships.
    assert StepCompiler(rulebook).at_own_steps().rules == fresh.rules
    assert not [*folder.rglob("*.machine")][1:]
    with keeping():
        shown = StepCompiler(rulebook).at_own_steps()
        assert shown.rules == fresh.rules
        assert shown.spot == fresh.spot
        assert all(one.certificate for one in second_compiler.certified(shown).rules)
        # Whoever names a compiler wants it to work.
        monkeypatch.setenv("RULEC_COMPILER", "spot")
        with pytest.raises(TypeError):
            StepCompiler(rulebook).at_own_steps()


@pytest.mark.long
@pytest.mark.spot
@pytest.mark.parametrize("name", shipped_caches.names())
def test_what_ships_is_what_is_compiled(name, tmp_path, monkeypatch):
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(compiler, "answers_to", ASKED)
    there = shipped(machine_cache.SHIPPED, machine_cache.MAKERS)
    assert there.keys
    with monkeypatch.context() as patched:
        patched.setattr(machine_cache, "shipped", lambda *_: shipped_bytes.ShippedBytes({}))
        fresh, _ = shipped_caches.asked_for(name)
    assert all(there.recall(key) == data for key, data in fresh.items())
