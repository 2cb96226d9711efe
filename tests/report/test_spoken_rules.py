"""Rules in sentences: three levels at most, and nothing lost below a name."""

import re
from dataclasses import replace

import pytest

from rulec.logic.fold import fold_constants
from rulec.logic.formula import Atom, Constant
from rulec.logic.free_names import rename_variables
from rulec.logic.one_point import plain, replaced
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.french import FRENCH
from rulec.logic.sentences.german import GERMAN
from rulec.logic.sentences.sentence_layout import lines
from rulec.logic.sentences.spoken_words import spoken_formula
from rulec.report.rulebooks.spoken_rules import MOST_LEVELS, atoms_in, counted_in, sentences_of
from rulec.rulebook.files.search_path import available_rulebooks
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from rulec.rulebook.vocabulary_phrases import phrases_of

NAMED = re.compile(r"“([^”]+)” holds(?: of (.+?))? if and only if ")


@pytest.mark.parametrize("name", available_rulebooks(()))
def test_no_sentence_has_more_than_three_levels(name):
    book = load_rulebook(name)
    for rule in book.rules:
        for said in sentences_of(rule, book).every:
            assert max(line.depth for line in lines(said)) <= MOST_LEVELS == 3, rule.name


@pytest.mark.parametrize("language", [GERMAN, FRENCH], ids=lambda language: language.code)
def test_other_languages_have_no_more_levels(language):
    book = load_rulebook("it")
    for rule in book.rules:
        for said in sentences_of(rule, book, language).every:
            assert max(line.depth for line in lines(said, language)) <= MOST_LEVELS


@pytest.mark.parametrize("name", ["de", "it", "kr", "us-nv"])
def test_with_the_meanings_of_the_names_it_is_the_rule(name):
    book = load_rulebook(name)
    phrases = phrases_of(book)
    n_named = 0
    for rule in book.rules:
        kinds = counted_in(rule.formula) | {own.name: own.type for own in rule.variables}
        said = sentences_of(rule, book)
        # What a declared word means is said, too, and the rule has the word itself
        named_here = [each for each in said.definitions if NAMED.match(each.text)]
        said = replace(said, definitions=tuple(named_here))
        meanings = {}
        for each in said.definitions:
            named, objects = NAMED.match(each.text).groups()
            meanings[named] = tuple(re.split(", | and ", objects or "")), each.of
        assert len(meanings) == len(said.definitions), "each is said once"
        n_named += len(meanings)

        def unfolded(formula, meanings=meanings):
            for use in atoms_in(formula):
                if use.name in meanings:
                    objects, body = meanings[use.name]
                    given = dict(zip(objects, use.arguments, strict=False))
                    meant = rename_variables(body, given)
                    return unfolded(replaced(formula, {use: meant}))
            return formula

        def written(formula, kinds=kinds):
            shorter = plain(fold_constants(formula), kinds, book.vocabulary.is_subtype)
            return spoken_formula(fold_constants(shorter), phrases, ENGLISH)

        parts = [rule.required or rule.formula, *(each.formula for each in rule.exemptions)]
        expected = [written(part) for part in parts]
        expected = [part for part in expected if part != Constant(False)]
        sentences = [said.requirement, *said.restrictions]
        if rule.condition is not None and len(said.restrictions) == len(expected):
            expected.insert(1, written(rule.condition))
        for one, formula in zip(sentences, expected, strict=True):
            assert one.of is None or written(unfolded(one.of)) == formula, rule.name
    assert n_named > 20


BOOK = """
rulebook zoo
type animal
signal eats, sleeps, flies, swims, hides default false
signal near(a: animal), far(a: animal) default false
define awake(a) = not sleeps and (eats or flies and (swims or hides and (near(a) or far(a))))
hard rule calm(v: animal) {
  require never (eats and (swims or not (flies and (hides or awake(v) and awake(v)))))
}
"""


def test_definitions_are_said_by_name_and_what_has_none_by_letters():
    book = parse_rulebook(BOOK)
    (rule,) = book.rules
    said = [line.text for each in sentences_of(rule, book).every for line in lines(each)]
    assert "“awake” holds of v" in " ".join(said)
    (meaning,) = [text for text in said if text.startswith("“awake” holds of v if and only if")]
    assert meaning.endswith("these hold:")
    (letter,) = [text for text in said if text.startswith("“A” holds")]
    assert "of v if and only if" not in letter, "v is the rule's own"
    assert Atom("A") not in [*atoms_in(rule.formula)]
