"""What a check found is recalled while nothing has changed, and only then."""

import os
import subprocess
import sys
from datetime import date
from pathlib import Path

import pytest

from rulec.cache import cache_folder as cache_folder_module
from rulec.cache.cache_folder import cache_folder, program_digest
from rulec.cache.keeping import keeping
from rulec.rulebook import loader
from rulec.rulebook.batch import batch_check
from rulec.rulebook.reading import reading_cache
from rulec.rulebook.reading.reading_cache import BookQuestion, recalled, remember_findings
from support.builders.rulebook_projects import project_in

WORDS = "vocabulary words {\n  signal p, q \n}\n"
BASE = "rulebook base\nuse words\nhard rule first { require always p }\n"
BOOK = "rulebook book\nextends base\nhard rule second { require always q }\n"


class Tomorrow(date):
    @classmethod
    def today(cls):
        return cls(2030, 1, 1)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    return project_in(tmp_path, monkeypatch, words=WORDS, base=BASE, book=BOOK)


@pytest.fixture
def made(monkeypatch):
    """The files that have been checked anew."""
    names = []

    def noting(name, *others):
        names.append(name)
        return original(name, *others)

    original = loader.diagnose
    monkeypatch.setattr(loader, "diagnose", noting)
    return names


def check(reference="book.rules", at="", search_path=(), data=b""):
    with keeping():
        done = batch_check.check([reference], lambda: data, search_path, at)
    assert not done.unread
    return [(one.code, one.place.file, one.message) for one in done.findings]


def test_what_has_not_changed_is_recalled(folder, made):
    first = check()
    assert check() == first
    assert made == ["book.rules"]


@pytest.mark.parametrize("name", ["book", "base", "words"])
def test_a_change_anywhere_counts(folder, made, name):
    assert check() == []
    path = folder / f"{name}.rules"
    path.write_text(f"# another\n{path.read_text()}".replace(" q ", " qq "))
    again = check()
    assert len(made) == 2
    # `qq` is in `book` or in the vocabulary alone, so one of them lacks a word; `base` has no `q`.
    assert [code for code, _, _ in again] == ([] if name == "base" else ["R0202"])


@pytest.mark.parametrize("formula", ["always qq or p(v) or 1 m", "never p then q"])
def test_a_mistake_is_recalled_in_every_detail(folder, made, formula):
    """Errors; and a warning."""
    (folder / "book.rules").write_text(BOOK.replace("always q", formula))
    with keeping():
        found = [batch_check.check(["book.rules"], bytes).findings for _ in range(2)]
    assert found[0] == found[1] != ()
    assert made == ["book.rules"]


def test_a_file_that_comes_nearer_counts(folder, made):
    (folder / "vocabulary").mkdir()
    (folder / "words.rules").rename(folder / "vocabulary" / "words.rules")
    assert check() == []
    (folder / "words.rules").write_text("vocabulary words {\n  signal p\n}\n")
    assert [code for code, _, _ in check()] == ["R0202"]


def test_a_file_that_comes_nearer_with_the_same_words_is_the_one_named(folder, made):
    (folder / "vocabulary").mkdir()
    (folder / "words.rules").rename(folder / "vocabulary" / "words.rules")
    farther = folder / "vocabulary" / "words.rules"
    farther.write_text(WORDS.replace("p, q", "p, q, p"))
    assert [file for _, file, _ in check()] == ["vocabulary/words.rules"]
    assert [file for _, file, _ in check()] == ["vocabulary/words.rules"]
    assert len(made) == 1
    (folder / "words.rules").write_bytes(farther.read_bytes())
    assert [file for _, file, _ in check()] == ["words.rules"]


def test_a_file_that_goes_or_comes_counts(folder, made):
    (folder / "words.rules").rename(folder / "other.txt")
    assert "R0703" in [code for code, _, _ in check()]
    (folder / "other.txt").rename(folder / "words.rules")
    assert check() == []
    (folder / "words.rules").unlink()
    assert "R0703" in [code for code, _, _ in check()]


def test_the_day_counts(folder, made):
    check()
    check(at="2020-01-01")
    check(at="2020-01-02")
    check(at="2020-01-01")
    assert len(made) == 3


@pytest.mark.parametrize(
    ("at", "as_of", "is_known"),
    [("", "", False), ("2026-01-01", "", True), ("", "2022-01-28", True)],
)
def test_a_rulebook_without_a_day_is_asked_again_on_another_day(
    folder, monkeypatch, at, as_of, is_known
):
    question = BookQuestion("a.rules", b"x", at=at)
    with keeping():
        remember_findings(question, (), (), as_of)
        assert recalled(question)[0].findings == ()
        monkeypatch.setattr(reading_cache, "date", Tomorrow)
        assert (recalled(question)[0] is not None) == is_known


def test_the_search_path_counts(folder, made, tmp_path):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        text = WORDS if name == "one" else WORDS.replace(", q", "")
        (tmp_path / name / "words.rules").write_text(text)
    (folder / "words.rules").unlink()
    assert check(search_path=[tmp_path / "one"]) == []
    assert [code for code, _, _ in check(search_path=[tmp_path / "two"])] == ["R0202"]
    # Each is kept for itself.
    assert check(search_path=[tmp_path / "one"]) == []
    assert len(made) == 2


def test_files_of_one_name_in_two_folders_are_kept_apart(folder, made, tmp_path, monkeypatch):
    other = tmp_path / "other"
    other.mkdir()
    for name in ("base", "book"):
        (other / f"{name}.rules").write_bytes((folder / f"{name}.rules").read_bytes())
    (other / "words.rules").write_text(WORDS.replace(", q", ""))
    for _ in range(2):
        monkeypatch.chdir(folder)
        assert check() == []
        monkeypatch.chdir(other)
        assert [code for code, _, _ in check()] == ["R0202"]
    assert len(made) == 2


def test_standard_input_is_recalled_by_its_text(folder, made):
    assert check("-", data=BOOK.encode()) == []
    assert check("-", data=BOOK.encode()) == []
    assert check("-", data=BOOK.replace("always q", "always x").encode()) != []
    assert len(made) == 2


@pytest.mark.parametrize(
    ("module", "name", "value"),
    [
        (cache_folder_module, "__version__", "0.0.0"),
        (cache_folder_module, "package_files", lambda: [("wei\udcdf/a.py", Path(__file__).stat())]),
    ],
)
def test_another_rulec_checks_anew(folder, made, monkeypatch, module, name, value):
    check()
    # As in another process, which asks once for the program's own files.
    program_digest.cache_clear()
    monkeypatch.setattr(module, name, value)
    check()
    check()
    program_digest.cache_clear()
    assert len(made) == 2


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.write_bytes(b""),
        lambda path: path.write_bytes(path.read_bytes()[:-9]),
        lambda path: path.write_bytes(b"\xff\xfe{}"),
        lambda path: path.write_bytes(path.read_bytes()[:-1] + b" "),
        lambda path: path.write_bytes(path.read_bytes()[32:]),
    ],
)
def test_damage_costs_time_only(folder, made, damage):
    check()
    (kept,) = cache_folder().glob("*.reading")
    damage(kept)
    assert check() == []
    assert len(made) == 2
    assert check() == []
    assert len(made) == 2


@pytest.mark.parametrize("mode", [0o660, 0o606])
def test_what_others_may_write_to_is_not_trusted(folder, made, mode):
    check()
    (kept,) = cache_folder().glob("*.reading")
    assert kept.stat().st_mode & 0o777 == 0o600
    kept.chmod(mode)
    assert check() == []
    assert len(made) == 2
    cache_folder().chmod(0o770)
    assert check() == check() == []
    assert len(made) == 4


def test_what_somebody_else_has_written_is_not_trusted(folder, made, monkeypatch):
    check()
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    assert check() == check() == []
    assert len(made) == 3


def test_the_default_folder_is_closed_to_others(folder, made, monkeypatch, tmp_path):
    monkeypatch.delenv("RULEC_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (tmp_path / "rulec").mkdir()
    (tmp_path / "rulec").chmod(0o777)
    assert check() == check() == []
    assert len(made) == 1
    assert (tmp_path / "rulec").stat().st_mode & 0o777 == 0o755


def test_no_place_to_keep_it_costs_time_only(folder, made, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("not a folder")
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "file" / "cache"))
    assert check() == check() == []
    assert len(made) == 2


def test_a_long_line_that_is_quoted_again_and_again_is_kept_once(folder, made):
    rules = "".join(f"hard rule r{number} {{ require q{number} }} " for number in range(300))
    (folder / "many.rules").write_text(f"rulebook many\n{rules}\n")
    first = check("many.rules")
    assert check("many.rules") == first
    assert len(first) >= 300
    assert made == ["many.rules"]
    assert sum(path.stat().st_size for path in cache_folder().iterdir()) < 10 * len(rules)


def test_mistakes_in_one_line_share_its_text(folder):
    rules = "hard rule r { require always q } hard rule s { require always t }"
    (folder / "two.rules").write_text(f"rulebook two\n{rules}\n")
    found = batch_check.check(["two.rules"], lambda: b"").findings
    first, second = [one.place.excerpt for one in found if one.code == "R0202"]
    assert first is second
    assert first == rules


def test_the_folder_is_the_users_own(monkeypatch, tmp_path):
    monkeypatch.delenv("RULEC_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "rulec"
    monkeypatch.setenv("XDG_CACHE_HOME", "not/absolute")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_folder() == tmp_path / ".cache" / "rulec"


def test_recalling_imports_neither_the_parser_nor_the_language(folder):
    program = (
        "import sys; from rulec.cli.main import main; status = main(['check', 'book.rules']);"
        "assert status == 0; print(*sorted(m for m in sys.modules"
        " if m.startswith(('rulec.syntax', 'rulec.logic', 'lark', 'rulec.rulebook.loader'))))"
    )
    run = [
        subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=True
        ).stdout.splitlines()
        for _ in range(2)
    ]
    assert (
        run[0][0]
        == run[1][0]
        == "1 file checked, no mistakes found; `rulec test` runs the examples"
    )
    assert "rulec.syntax" in run[0][-1]
    assert run[1][-1] == ""
