"""Phrases: every word of a vocabulary that ships has one in each language, of its own."""

import re
from fractions import Fraction

import pytest

from rulec.logic.formula import Atom, Comparison, QuantityTerm
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.language import LANGUAGES
from rulec.logic.sentences.spoken_words import forms, spoken_formula
from rulec.logic.sentences.wording import atom_clause, comparison_clause
from rulec.rulebook.loader import load_vocabulary
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from rulec.rulebook.vocabulary_phrases import phrases_in, phrases_of
from rulec.vocabulary import Enumeration, Quantity


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_word_has_a_phrase_of_its_own(language):
    phrases = phrases_in("road", language)
    words = {}
    for name, item in load_vocabulary("road").declarations.items():
        words |= dict.fromkeys(item.values if isinstance(item, Enumeration) else (name,), item)
    assert phrases.keys() == words.keys()
    said = []
    for name, phrase in phrases.items():
        affirmed, denied = forms(phrase)
        said += [affirmed] if isinstance(words[name], Quantity) else [affirmed, denied]
        assert (affirmed == denied) is isinstance(words[name], Quantity), name
        for form in (affirmed, denied):
            assert form.count("{}") == len(words[name].parameters), name
            assert not set("[]|") & set(form), name
            assert form == " ".join(form.split()), name
    assert len(said) == len(set(said))


@pytest.mark.parametrize(
    ("language", "somebody"),
    [
        ("en", r"(an?|another|some\w*|one) .* (do|does|is|are|did) not\b"),
        ("en", r"there is(?! (a|an|no)? )"),
        ("de", r"(ein|eine|jemand) .*\bnicht\b"),
        ("fr", r"(une?|quelqu'un) .*\b(ne|n')"),
    ],
)
def test_what_is_denied_of_anybody_is_denied_of_all(language, somebody):
    # "A sign does not forbid it" leaves open whether another one does.
    for name, phrase in {**phrases_in("road", language), **phrases_in("schemas", language)}.items():
        _, denied = forms(phrase)
        assert not re.match(somebody, denied), name


def test_what_is_said_in_french_is_not_half_denied():
    for name, phrase in {**phrases_in("road", "fr"), **phrases_in("schemas", "fr")}.items():
        affirmed, _ = forms(phrase)
        denying = re.search(r"\bne\b|\bn'|\b(a|tracte) de\b| ou n'", affirmed)
        assert not denying or "n'a rien" in affirmed or "n'a aucun" in affirmed, name


@pytest.mark.parametrize("language", LANGUAGES)
def test_words_that_books_add_have_phrases_too(language):
    added = load_rulebook("schemas").vocabulary.declarations.keys()
    added -= load_vocabulary("road").declarations.keys()
    phrases = phrases_in("schemas", language)
    assert phrases.keys() == added
    for name, phrase in phrases.items():
        declared = load_rulebook("schemas").vocabulary.declarations[name]
        affirmed, denied = forms(phrase)
        assert (affirmed == denied) is isinstance(declared, Quantity), name
        for form in (affirmed, denied):
            assert form.count("{}") == len(declared.parameters), name
            assert form == " ".join(form.split()), name
    spoken = phrases_of(load_rulebook("nl"), language)
    assert spoken["ahead_for"] == phrases["ahead_for"]


def test_sentences_speak_in_phrases_and_keep_their_reading():
    phrases = phrases_of(load_rulebook("vienna"))
    formula = spoken_formula(Atom("dense_all_lanes"), phrases)
    assert atom_clause(formula, ENGLISH, holds=False) == (
        "queues do not fill all lanes of ego's direction"
    )
    raining = spoken_formula(Atom("raining"), phrases)
    # What holds a comma or an `or` of its own stays apart from what it is joined with.
    assert atom_clause(raining, ENGLISH, holds=True) == "“rain, snow or hail falls”"


def test_a_noun_with_the_name_of_another_quantity_in_it_is_said_once():
    speed, limit = (Fraction(1), QuantityTerm("speed")), (Fraction(-1), QuantityTerm("limit"))
    below = Comparison((speed, limit), "<=", Fraction(0), "speed <= limit")
    spoken = spoken_formula(below, phrases_in("road", "en"))
    assert comparison_clause(spoken, ENGLISH, holds=True) == (
        "ego's speed is at most the signposted speed limit"
    )
