"""One rule in a document for lawyers, as Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from difflib import unified_diff
from textwrap import wrap

from rulec.analysis.lineage.rule_lineage import BookLineage, RuleHistory
from rulec.logic.bounds import has_seconds
from rulec.logic.english.sentence import Phrase
from rulec.logic.english.sentence_layout import lines
from rulec.logic.english.wording import amount, listed, number_text, spoken
from rulec.logic.printing import formula_text
from rulec.report.rulebooks.rule_page import phrase_of, restrictions_of
from rulec.report.rulebooks.rule_provenance import provenance
from rulec.report.text.formula_lines import formula_lines
from rulec.report.text.markdown import Block, Heading, code, escaped, fenced, linked, table
from rulec.rulebook.rulebook_model import Example, Rule, Rulebook
from rulec.syntax import tree
from rulec.syntax.tree_printer import clauses_of, print_in_force
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary

WIDTH = 84
"""The longest line of a formula: about what a printed page has."""

CERTAINTY: Mapping[str, str] = {
    "verified": "✔ verified in the law itself",
    "secondary": "◐ taken from a secondary source",
    "unverified": "✎ written from memory, not yet checked",
    "": "? not stated",
}

NOTHING = "–"
"""What stands where a state does not say something that has no default either."""

_FORMULAS = ("when", "require", "unless")


def rule_heading(rule: Rule) -> str:
    """The heading of its section."""
    return f"{rule.name} ({rule.cite})" if rule.cite else rule.name


def rule_section(rule: Rule, inherited: BookLineage, rulebook: Rulebook) -> Iterator[Block]:
    """The section on a rule of the rulebook at a chain's end."""
    book, vocabulary = inherited.book, rulebook.vocabulary
    history = next(history for history in inherited.rules if history.name == rule.name)
    laws = {book.name: book.law or book.title or book.name for book in inherited.books}
    elsewhere = "" if history.cited_by == book else f" of: {laws[history.cited_by]}"
    yield Heading(3, rule_heading(rule))
    if rule.says:
        yield f"> {escaped(rule.says)}"
    facts = _facts(rule, history, inherited, elsewhere)
    titles = [escaped(topic.title) for topic in rulebook.topics if topic.name in rule.topics]
    topics = [("Topic", listed(titles))] if titles else []
    yield "\n".join(f"- **{name}:** {text}" for name, text in (*facts, *topics))
    yield Heading(4, "In plain English")
    for phrase in (phrase_of(rule, vocabulary), *restrictions_of(rule)):
        yield _sentence(phrase)
    yield Heading(4, "Formula")
    yield from _formula(rule, history.rule)
    yield Heading(4, "Examples")
    if not rule.examples:
        yield "None."
    elif has_seconds(rule.formula):
        yield f"The states are {amount(rule.step_s, 's')} apart."
    for number, example in enumerate(rule.examples, 1):
        yield from _example(example, number, vocabulary)
    base = history.before(book)
    if (
        history.last.deed in ("overridden", "confirmed")
        and history.last.book == book
        and base is not None
    ):
        yield Heading(4, f"What differs from {history.steps[-2].book}")
        yield from _difference(base, history)


def _facts(
    rule: Rule, history: RuleHistory, inherited: BookLineage, elsewhere: str
) -> Iterator[tuple[str, str]]:
    open_law = "; inherited, not confirmed" if rule.inherited_from else ""
    cited = f"{rule.cite}{elsewhere}" if rule.cite else "none is cited"
    yield "Provision", escaped(f"{cited}{open_law}")
    hard = rule.strength == "hard"
    weight = f"; weight {number_text(rule.weight)}" if not hard or rule.weight != 1 else ""
    kind = "hard, it must never be violated" if hard else "soft, it may yield"
    yield "Kind of rule", f"{kind}{weight}"
    if rule.level:
        yield "Level", code(rule.level)
    objects = [f"every {spoken(item.type)} {code(item.name)}" for item in rule.variables]
    yield "Speaks of", listed(objects) if objects else "the road user in question and the world"
    of_whose = f"; that is {rule.inherited_from}'s" if rule.inherited_from else ""
    yield "Certainty", escaped(f"{CERTAINTY[rule.certainty]}{of_whose}")
    if rule.source:
        yield "Read in", linked(rule.source)
    if rule.in_force_from or rule.in_force_until:
        dates = print_in_force(tree.InForce(rule.in_force_from, rule.in_force_until))
        yield "In force", dates.removeprefix("in force ")
    yield "Origin", escaped(provenance(history, inherited))


def _sentence(phrase: Phrase) -> str:
    first, *rest = lines(phrase)
    items = [f"{'  ' * (line.depth - 1)}- {line.label} {escaped(line.text)}" for line in rest]
    return escaped(first.text) + ("\n\n" + "\n".join(items) if items else "")


def _formula(rule: Rule, written: tree.RuleItem | None) -> Iterator[str]:
    clauses = [] if written is None else clauses_of(written)
    original = [(word, text) for word, text in clauses if word in _FORMULAS]
    expanded = [] if rule.condition is None else [("when", formula_text(rule.condition))]
    expanded.append(("require", formula_text(rule.required or rule.formula)))
    expanded += [
        ("unless", f"{formula_text(exemption.formula)} {exemption.scope}")
        for exemption in rule.exemptions
    ]
    yield _fenced(original)
    if original != expanded:
        yield "With definitions, options and parameters put in:"
        yield _fenced(expanded)


def _fenced(clauses: Sequence[tuple[str, str]]) -> str:
    return fenced("\n".join(line for clause in clauses for line in _clause(*clause)), "rulec")


def _clause(word: str, text: str) -> list[str]:
    shown = f"{word} {text}"
    if word in _FORMULAS:
        return formula_lines(shown, WIDTH)
    return wrap(shown, WIDTH, subsequent_indent="  ", break_long_words=False)


def _example(example: Example, number: int, vocabulary: Vocabulary) -> Iterator[str]:
    word = "allowed ✔" if example.accepts else "forbidden ✘"
    name = f" ({escaped(example.label)})" if example.label else ""
    objects = [f"{code(object_.name)}, a {spoken(object_.type)}" for object_ in example.objects]
    there = f" Also there: {listed(objects)}." if objects else ""
    yield f"**Example {number}{name}: {word}**{there}"
    rows = [[*map(escaped, row)] for row in example_rows(example, vocabulary)]
    if rows:
        yield table(["state", *map(str, range(len(example.states)))], rows)
    else:
        yield "Nothing is mentioned: everything has its default."


def example_rows(example: Example, vocabulary: Vocabulary) -> Iterator[list[str]]:
    """A row for each subject, in order of mention: its value in each state.

    A value in parentheses is a default: the state does not mention it.
    """
    for name, objects in dict.fromkeys(key for state in example.states for key in state):
        item = vocabulary.declarations[name]
        unit = f", {item.unit}" if isinstance(item, Quantity) else ""
        of = f" of {listed(objects)}" if objects else ""
        default = NOTHING if item.default is None else f"({_value(item, item.default)})"
        values = [state.get((name, objects)) for state in example.states]
        cells = [default if value is None else _value(item, value) for value in values]
        yield [f"{spoken(name)}{of}{unit}", *cells]


def _value(item: Declaration, value: bool | str | float) -> str:
    match item, value:
        case Signal(), _:
            return "yes" if value else "no"
        case Enumeration(), _:
            return spoken(str(value))
        case _:
            return repr(float(value)).removesuffix(".0")


def _difference(base: tree.RuleItem, history: RuleHistory) -> Iterator[str]:
    assert history.rule is not None, "an overridden rule is there"
    before, after = _by_word(base), _by_word(history.rule)
    changed = [word for word in {**before, **after} if before.get(word) != after.get(word)]
    clauses = history.last.clauses
    yield f"Changed: {listed(clauses)}." if clauses else "Nothing: it says the same again."
    if changed:
        old = [line for word in changed for line in before.get(word, [])]
        new = [line for word in changed for line in after.get(word, [])]
        shown = list(unified_diff(old, new, lineterm="", n=len(old) + len(new)))
        # The first three lines name files and lines, and there are none.
        yield fenced("\n".join(shown[3:]), "diff")


def _by_word(rule: tree.RuleItem) -> dict[str, list[str]]:
    lines: dict[str, list[str]] = {}
    for word, text in clauses_of(rule):
        lines.setdefault(word, []).extend(_clause(word, text))
    return lines
