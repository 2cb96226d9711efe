"""Rules without a provision or an example, as a text shows them."""

import pytest

from rulec.resources import rulebooks_folder
from rulec.rulebook.batch.batch_check import bare_rules
from rulec.rulebook.reading.rulebook_reader import read_rulebook


def test_what_is_bare_is_named():
    text = (
        "rulebook r\n# hard rule no { cite }\n"
        'hard rule a { says "I cite no one" require never p }\n'
        'hard rule b { cite "1" require never p reject { p } }\n'
        "soft rule c { require never p accept { not p } }\n"
        'hard rule f { cite " " says "cite" require never p accept { p } }\n'
        "override hard rule d { require never p }\nconfirm rule e\n"
    )
    assert bare_rules(text) == (["a", "c", "f"], ["a"])


@pytest.mark.parametrize("text", ["", "rulebook r\n", "vocabulary v { signal p }\n"])
def test_where_there_is_no_rule_nothing_is(text):
    assert bare_rules(text) == ([], [])


@pytest.mark.parametrize("name", ["esterle2019", "vienna", "schemas"])
def test_of_a_shipped_rulebook_it_is_what_its_rules_lack(name):
    book = read_rulebook(name).rulebook
    text = (rulebooks_folder() / name / f"{name}.rules").read_text()
    own = {rule.name: rule for rule in book.rules if f"rule {rule.name} " in text}
    uncited, untested = bare_rules(text)
    assert [rule for rule in uncited if rule in own and own[rule].cite] == []
    assert [rule for rule in untested if rule in own and own[rule].examples] == []
    assert {one for one in own if not own[one].cite} <= {*uncited}
