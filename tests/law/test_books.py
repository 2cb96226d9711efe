"""Every national rulebook is sound: no warnings, examples both ways, automata, sources."""

import pytest

from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.monitoring.batch.stacked.stacked_rule import StackedRule
from rulec.monitoring.uncertainty.judged_rules import judged_rules
from rulec.rulebook.reading.rulebook_reader import read_rulebook
from support.builders.national_books import FOLDER, NATIONAL, compiled, read

of_every_book = pytest.mark.parametrize("name", NATIONAL)


@of_every_book
def test_a_book_has_no_mistakes_and_no_warnings(name: str) -> None:
    assert read(name).warnings == ()
    assert read(name).rulebook.name == name


def test_the_shared_patterns_have_no_mistakes() -> None:
    schemas = read_rulebook(FOLDER / "schemas" / "schemas.rules")
    assert schemas.warnings == ()
    assert schemas.rulebook.rules == ()


@of_every_book
def test_its_examples_come_out_as_they_say(name: str) -> None:
    outcomes = run_rulebook_examples(read(name).rulebook, compiled(name)).outcomes
    assert [one for one in outcomes if not one.passed] == []


@of_every_book
def test_each_rule_shows_what_it_allows_and_what_it_forbids(name: str) -> None:
    for rule in read(name).rulebook.rules:
        assert {example.accepts for example in rule.examples} == {True, False}, rule.name


@of_every_book
def test_each_rule_says_where_it_comes_from(name: str) -> None:
    for rule in read(name).rulebook.rules:
        assert all((rule.cite, rule.says, rule.source, rule.certainty, rule.level)), rule.name


@of_every_book
def test_nothing_is_verified_of_which_a_part_was_not_read(name: str) -> None:
    for rule in read(name).rulebook.rules:
        elsewhere = any(word in rule.source for word in ("memory", "excerpt", "secondary"))
        assert rule.certainty != "verified" or not elsewhere, rule.name


@of_every_book
def test_a_book_says_whose_law_it_is_and_on_which_day(name: str) -> None:
    rulebook = read(name).rulebook
    assert all((rulebook.title, rulebook.law, rulebook.as_of, rulebook.traffic))


@of_every_book
def test_a_book_lists_its_law_s_articles_and_says_whether_they_were_read(name: str) -> None:
    provisions = read(name).rulebook.provisions
    assert provisions
    for article in provisions:
        assert all((article.number, article.heading, article.link, article.as_of)), article.number
        assert article.certainty, article.number


@of_every_book
def test_each_rule_has_an_automaton_that_can_be_kept_and_violated(name: str) -> None:
    for rule in compiled(name).rules:
        assert rule.hoa.startswith("HOA: v1")
        outputs = {verdict for row in rule.machine.outputs for verdict in row}
        assert outputs == {True, False}, rule.name


@of_every_book
def test_every_rule_is_judged_in_arrays(name: str) -> None:
    """Not so one that asks of other objects who they are: of a town it takes hours."""
    book = compiled(name)
    judged = judged_rules(book, frozenset(book.vocabulary.declarations), cut=True)
    ready = [StackedRule(rule, own, book, judged.vocabulary, {}) for rule, own in judged.machines]
    assert [rule.rule.name for rule in ready if not rule.is_simple] == []
