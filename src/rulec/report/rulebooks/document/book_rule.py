"""One rule in a document for lawyers, as Markdown."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from difflib import unified_diff
from textwrap import wrap
from typing import TypeAlias

from rulec.analysis.lineage.rule_lineage import BookLineage, RuleHistory
from rulec.logic.bounds import has_seconds
from rulec.logic.sentences.language import Language
from rulec.logic.sentences.sentence import Phrase
from rulec.logic.sentences.sentence_layout import lines
from rulec.logic.sentences.wording import amount, listed, number_text, spoken
from rulec.report.rulebooks.document_language import IN_ENGLISH, DocumentLanguage, provenance
from rulec.report.rulebooks.spoken_rules import sentences_of
from rulec.report.text.formula_lines import formula_lines, plain_clauses
from rulec.report.text.markdown import Block, Heading, code, escaped, fenced, linked, table
from rulec.rulebook.rulebook_model import Example, Rule, Rulebook
from rulec.syntax import tree
from rulec.syntax.tree_printer import clauses_of
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary

WIDTH = 84
"""Longest line of a formula in characters: about the width of a printed page."""

CERTAINTY: Mapping[str, str] = {
    "verified": "✔ verified in the law itself",
    "secondary": "◐ taken from a secondary source",
    "unverified": "✎ written from memory, not yet checked",
    "": "? not stated",
}

NOTHING = "–"
"""The cell of a state without a value for something that has no default."""

_FORMULAS = ("when", "require", "unless")


ExamplePicture: TypeAlias = Callable[[Example, Rule], str]
"""The address of an image of a rule's example, as data; empty if there is nothing to draw."""


def rule_heading(rule: Rule, words: DocumentLanguage) -> str:
    """The heading of a rule's section."""
    title = words.title(rule.name)
    return f"{title} ({rule.cite})" if rule.cite else title


def time_in_force(since: str | None, until: str | None, words: DocumentLanguage) -> str:
    """``from DATE until DATE``; empty if always in force."""
    begins = words.say("from {}", since) if since else ""
    ends = words.say("until {}", until) if until else ""
    return f"{begins} {ends}".strip()


def rule_section(
    rule: Rule,
    inherited: BookLineage,
    rulebook: Rulebook,
    words: DocumentLanguage,
    picture: ExamplePicture | None,
) -> Iterator[Block]:
    """The section on a rule in the last rulebook of a chain."""
    say = words.say
    book, vocabulary = inherited.book, rulebook.vocabulary
    history = next(history for history in inherited.rules if history.name == rule.name)
    laws = {book.name: book.law or book.title or book.name for book in inherited.books}
    elsewhere = "" if history.cited_by == book else say(" of: {}", laws[history.cited_by])
    yield Heading(3, rule_heading(rule, words))
    if rule.says:
        yield f"> {escaped(rule.says)}"
    facts = _facts(rule, history, inherited, elsewhere, words)
    titles = [
        escaped(words.topics.get(topic.name, topic.title))
        for topic in rulebook.topics
        if topic.name in rule.topics
    ]
    topics = [(say("Topic"), listed(titles, words.language))] if titles else []
    yield "\n".join(f"- **{name}:** {text}" for name, text in (*facts, *topics))
    yield Heading(4, say("In plain English"))
    language = words.language
    for phrase in sentences_of(rule, rulebook, language).every:
        yield _sentence(phrase, language)
    yield Heading(4, say("Formula"))
    yield from _formula(rule, history.rule, words)
    yield Heading(4, say("Examples"))
    if not rule.examples:
        yield say("None.")
    elif has_seconds(rule.formula):
        yield say("The states are {} apart.", amount(rule.step_s, "s", language))
    for number, example in enumerate(rule.examples, 1):
        drawn = "" if picture is None else picture(example, rule)
        yield from _example(example, number, drawn, vocabulary, words)
    base = history.before(book)
    if (
        history.last.deed in ("overridden", "confirmed")
        and history.last.book == book
        and base is not None
    ):
        yield Heading(4, say("What differs from {}", history.steps[-2].book))
        yield from _difference(base, history, words)


def _facts(
    rule: Rule,
    history: RuleHistory,
    inherited: BookLineage,
    elsewhere: str,
    words: DocumentLanguage,
) -> Iterator[tuple[str, str]]:
    say, language = words.say, words.language
    open_law = say("; inherited, not confirmed") if rule.inherited_from else ""
    cited = f"{rule.cite}{elsewhere}" if rule.cite else say("none is cited")
    yield say("Provision"), escaped(f"{cited}{open_law}")
    yield say("Rule"), code(rule.name)
    hard = rule.strength == "hard"
    weight = ""
    if not hard or rule.weight != 1:
        weight = say("; weight {}", number_text(rule.weight, language))
    kind = "hard, it must never be violated" if hard else "soft, it may yield"
    yield say("Kind of rule"), f"{say(kind)}{weight}"
    if rule.level:
        yield say("Level"), code(rule.level)
    objects = [
        f"{language.type_of(item.type, spoken(item.type)).every} {code(item.name)}"
        for item in rule.variables
    ]
    nobody = say("the road user in question and the world")
    yield say("Speaks of"), listed(objects, language) if objects else nobody
    of_whose = say("; that is {}'s", rule.inherited_from) if rule.inherited_from else ""
    yield say("Certainty"), escaped(f"{say(CERTAINTY[rule.certainty])}{of_whose}")
    if rule.source:
        yield say("Read in"), linked(rule.source)
    if rule.in_force_from or rule.in_force_until:
        dates = time_in_force(rule.in_force_from, rule.in_force_until, words)
        yield say("In force"), dates
    yield say("Origin"), escaped(provenance(history, inherited, words))


def _sentence(phrase: Phrase, language: Language) -> str:
    first, *rest = lines(phrase, language)
    items = [f"{'  ' * (line.depth - 1)}- {line.label} {escaped(line.text)}" for line in rest]
    return escaped(first.text) + ("\n\n" + "\n".join(items) if items else "")


def _formula(rule: Rule, written: tree.RuleItem | None, words: DocumentLanguage) -> Iterator[str]:
    clauses = [] if written is None else clauses_of(written)
    original = [(word, text) for word, text in clauses if word in _FORMULAS]
    expanded = plain_clauses(rule)
    yield _fenced(original)
    if original != expanded:
        yield words.say("With definitions, options and parameters put in:")
        yield _fenced(expanded)


def _fenced(clauses: Sequence[tuple[str, str]]) -> str:
    return fenced("\n".join(line for clause in clauses for line in _clause(*clause)), "rulec")


def _clause(word: str, text: str) -> list[str]:
    shown = f"{word} {text}"
    if word in _FORMULAS:
        return formula_lines(shown, WIDTH)
    return wrap(shown, WIDTH, subsequent_indent="  ", break_long_words=False)


def _example(
    example: Example, number: int, drawn: str, vocabulary: Vocabulary, words: DocumentLanguage
) -> Iterator[str]:
    say, language = words.say, words.language
    verdict = say("allowed ✔") if example.accepts else say("forbidden ✘")
    name = f" ({escaped(example.label)})" if example.label else ""
    objects = [
        f"{code(item.name)}, {language.type_of(item.type, spoken(item.type)).one}"
        for item in example.objects
    ]
    there = say(" Also there: {}.", listed(objects, language)) if objects else ""
    title = say("Example {}{}: {}", number, name, verdict)
    yield f"**{title}**{there}"
    if drawn:
        yield f"![{title.replace('[', '(').replace(']', ')')}]({drawn})"
    rows = [[*map(escaped, row)] for row in example_rows(example, vocabulary, words)]
    if rows:
        yield table([say("state"), *map(str, range(len(example.states)))], rows)
    else:
        yield say("Nothing is mentioned: everything has its default.")


def example_rows(
    example: Example, vocabulary: Vocabulary, words: DocumentLanguage = IN_ENGLISH
) -> Iterator[list[str]]:
    """A row for each subject, in order of mention, with its value in each state.

    A value in parentheses is a default, which the state does not mention.
    """
    for name, objects in dict.fromkeys(key for state in example.states for key in state):
        item = vocabulary.declarations[name]
        unit = f", {item.unit}" if isinstance(item, Quantity) else ""
        about = spoken(name)
        if objects:
            about = words.say("{} of {}", about, listed(objects, words.language))
        default = NOTHING if item.default is None else f"({_value(item, item.default, words)})"
        values = [state.get((name, objects)) for state in example.states]
        cells = [default if value is None else _value(item, value, words) for value in values]
        yield [f"{about}{unit}", *cells]


def _value(item: Declaration, value: bool | str | float, words: DocumentLanguage) -> str:
    match item, value:
        case Signal(), _:
            return words.say("yes") if value else words.say("no")
        case Enumeration(), _:
            return spoken(str(value))
        case _:
            return words.language.decimals(repr(float(value)).removesuffix(".0"))


def _difference(
    base: tree.RuleItem, history: RuleHistory, words: DocumentLanguage
) -> Iterator[str]:
    assert history.rule is not None, "an overridden rule is there"
    before, after = _by_word(base), _by_word(history.rule)
    changed = [word for word in {**before, **after} if before.get(word) != after.get(word)]
    clauses = history.last.clauses
    same = words.say("Nothing: it says the same again.")
    yield words.say("Changed: {}.", listed(clauses, words.language)) if clauses else same
    if changed:
        old = [line for word in changed for line in before.get(word, [])]
        new = [line for word in changed for line in after.get(word, [])]
        shown = list(unified_diff(old, new, lineterm="", n=len(old) + len(new)))
        # The first three lines would name files and line numbers, which do not exist.
        yield fenced("\n".join(shown[3:]), "diff")


def _by_word(rule: tree.RuleItem) -> dict[str, list[str]]:
    lines: dict[str, list[str]] = {}
    for word, text in clauses_of(rule):
        lines.setdefault(word, []).extend(_clause(word, text))
    return lines
