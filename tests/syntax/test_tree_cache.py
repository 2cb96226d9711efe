"""Trees are recalled by their whole text, places included, and only as they were written."""

import os

import pytest

from rulec.cache import kept_bytes
from rulec.cache.cache_folder import cache_folder
from rulec.cache.keeping import keeping
from rulec.cache.row_tables import RowTables
from rulec.diagnostics import Source, Span
from rulec.resources import rulebooks_folder
from rulec.syntax import parse, tree
from rulec.syntax.caching import tree_cache
from rulec.syntax.caching.tree_cache import TREES

RULE = 'hard rule r {\n  cite "Article 1"\n  require always (p implies q)\n}\n'


@pytest.fixture
def read(tmp_path, monkeypatch):
    """The texts that have been parsed, with a cache of their own."""
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "cache"))
    texts = []

    def noting(source):
        texts.append(source.text)
        return parse(source)

    monkeypatch.setattr(tree_cache, "parse", noting)
    with keeping():
        yield texts


def kept():
    return sorted(cache_folder().iterdir())


def written(file, source):
    """The data of a tree; places are not compared with trees."""
    return TREES.written(file, (source, tree.NOWHERE))


def test_what_is_recalled_is_what_was_parsed(read):
    text = f"rulebook a\n{RULE}"
    first, second = (
        Source("a.rules", text),
        Source("b.rules", text),
    )
    fresh, again = tree_cache.parsed(first)[0], tree_cache.parsed(second)[0]
    assert read == [text]
    assert again == fresh == parse(first)[0]
    # The same text in another file: places are in that one.
    assert again.items[0].name.span.source is second
    assert again.items[0].name.span.place.file == "b.rules"
    assert written(again, second) == written(fresh, first)


@pytest.mark.parametrize("name", ["de/de", "esterle2019/esterle2019", "vocabulary/road"])
def test_data_of_a_tree_has_all_of_it(name):
    path = rulebooks_folder() / f"{name}.rules"
    source = Source(path.name, path.read_text(encoding="utf-8"))
    file, mistakes = parse(source)
    assert mistakes == ()
    data = written(file, source)
    again = TREES.read(RowTables(data), (source, tree.NOWHERE))
    assert again == file
    assert written(again, source) == data


def test_who_imports_rulec_keeps_nothing(read):
    source = Source("a.rules", f"rulebook a\n{RULE}")
    with keeping(on=False):
        assert tree_cache.parsed(source) == tree_cache.parsed(source)
    assert len(read) == 2
    assert not cache_folder().exists()


@pytest.mark.parametrize(
    "text", ["rulebook a\nhard rule r { require always }\n", "", "{", "\ufffe"]
)
def test_what_has_mistakes_is_not_kept(read, text):
    source = Source("a.rules", text)
    assert tree_cache.parsed(source) == tree_cache.parsed(source) == parse(source)
    assert read == [text, text]
    assert not cache_folder().exists()


def test_another_text_or_another_rulec_reads_anew(read, monkeypatch):
    text = f"rulebook a\n{RULE}"
    tree_cache.parsed(Source("a.rules", text))
    tree_cache.parsed(Source("a.rules", f"{text}# more\n"))
    assert len(read) == len(kept()) == 2
    monkeypatch.setattr(kept_bytes, "program_digest", lambda: "another")
    tree_cache.parsed(Source("a.rules", text))
    assert len(read) == 3


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.write_bytes(b""),
        lambda path: path.write_bytes(path.read_bytes()[:-3]),
        lambda path: path.write_bytes(path.read_bytes()[:-1] + b"?"),
        lambda path: path.write_bytes(bytes(100)),
        lambda path: path.unlink(),
        lambda path: (path.unlink(), path.mkdir()),
        lambda path: path.chmod(0o666),
        lambda path: path.parent.chmod(0o770),
    ],
)
def test_a_damaged_file_or_one_that_others_can_write_is_not_read(read, damage):
    source = Source("a.rules", f"rulebook a\n{RULE}")
    first = tree_cache.parsed(source)
    (path,) = kept()
    damage(path)
    assert tree_cache.parsed(source) == first
    assert len(read) == 2


def test_what_somebody_else_has_written_is_not_read(read, monkeypatch):
    source = Source("a.rules", f"rulebook a\n{RULE}")
    first = tree_cache.parsed(source)
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    assert tree_cache.parsed(source) == first
    assert len(read) == 2


def test_a_file_under_another_name_is_not_read(read):
    one, other = (Source("a.rules", f"rulebook {name}\n{RULE}") for name in "ab")
    tree_cache.parsed(one)
    (path,) = kept()
    tree_cache.parsed(other)
    (second,) = set(kept()) - {path}
    second.write_bytes(path.read_bytes())
    assert tree_cache.parsed(other)[0].name.text == "b"
    assert len(read) == 3


def test_a_tree_whose_result_is_kept_is_not_kept_itself(read):
    source = Source("a.rules", f"rulebook a\n{RULE}")
    tree_cache.parsed(source, keeps=False)
    assert not cache_folder().exists()
    tree_cache.parsed(source)
    tree_cache.parsed(source, keeps=False)
    assert len(read) == 2


def test_a_span_of_another_text_is_not_encoded():
    node = tree.File("rulebook", None, span=Span(Source("b.rules", "p"), 0, 1))
    with pytest.raises(TypeError):
        written(node, Source("a.rules", "p"))


def test_the_longest_unused_go_first(read, monkeypatch):
    monkeypatch.setattr(tree_cache, "MOST_TREES", 3)
    sources = [Source("a.rules", f"rulebook b{number}\n{RULE}") for number in range(4)]
    for age, source in enumerate(sources[:3]):
        before = set(cache_folder().glob("*"))
        tree_cache.parsed(source)
        (path,) = set(kept()) - before
        os.utime(path, (age, age))
    tree_cache.parsed(sources[0])
    tree_cache.parsed(sources[3])
    assert len(kept()) == 2
    read.clear()
    for source in sources[:3]:
        tree_cache.parsed(source)
    assert read == [sources[1].text, sources[2].text]
