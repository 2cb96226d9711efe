"""What is wrong within a rule names the provision that the rule comes from."""

import pytest

from rulec.diagnostics import RulecError
from rulec.rulebook.reading.rulebook_reader import load_rulebook

BASE = 'rulebook base\nsignal p\nhard rule r {\n  cite "§ 1"\n  require always p\n}\n'


def notes(folder, name, text):
    (folder / f"{name}.rules").write_text(text)
    with pytest.raises(RulecError) as wrong:
        load_rulebook(f"{folder}/{name}.rules")
    return [found.notes for found in wrong.value.diagnostics]


def test_a_mistake_in_a_rule(tmp_path):
    assert notes(tmp_path, "base", BASE.replace("always p", "always q")) == [("rule `r` is § 1",)]


def test_a_mistake_of_spelling(tmp_path):
    assert notes(tmp_path, "base", BASE.replace("always p", "always p p")) == [("rule `r` is § 1",)]


def test_a_rule_without_end_is_the_one_that_began(tmp_path):
    two = BASE.replace("  require always p\n}", "  require always p") + (
        'hard rule s {\n  cite "§ 2"\n  require never p\n}\n'
    )
    assert notes(tmp_path, "base", two) == [("rule `r` is § 1",)]


def test_a_mistake_elsewhere(tmp_path):
    assert notes(tmp_path, "base", BASE + "define x = y\n") == [()]


def test_a_rule_that_cites_nothing(tmp_path):
    assert notes(tmp_path, "base", "rulebook base\nhard rule r { require q }\n") == [()]


def test_an_override_is_the_rule_of_what_it_overrides(tmp_path):
    (tmp_path / "base.rules").write_text(BASE)
    own = "rulebook own\nextends base\noverride rule r { require always q }\n"
    assert notes(tmp_path, "own", own) == [("rule `r` is § 1",)]
