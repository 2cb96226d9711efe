"""Code lenses above rules: questions about each, and their answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from lsprotocol import types as lsp

from rulec.api import lazy_imports as lazy
from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.language_server.names.name_occurrences import DocumentNames
from rulec.language_server.names.renaming import TextChange
from rulec.language_server.workspace.text_positions import TextPositions
from rulec.logic.formula import Formula
from rulec.logic.free_names import names_in
from rulec.rulebook.rulebook_model import Example, Rule, Rulebook
from rulec.syntax import tree
from rulec.trace.vocabulary_projection import with_told_values

RUN = "rulec.runExamples"
ENGLISH = "rulec.inEnglish"
COMPARE = "rulec.compareWithParent"
INSERT = "rulec.insertExample"

_MOST_KEPT = 2000


@dataclass(slots=True)
class KnownAnswers:
    """Answers about rules, valid while the rules, examples and parents asked about are equal."""

    examples: dict[Formula, tuple[tuple[Example, ...], ExampleAnswer]] = field(default_factory=dict)
    parents: dict[tuple[Formula, tuple[str, ...]], ParentAnswer] = field(default_factory=dict)

    def of_examples(self, rule: Rule) -> ExampleAnswer | None:
        """The results of a rule's examples; None if it has other examples now."""
        examples, answer = self.examples.get(rule.formula, ((), None))
        return answer if examples == rule.examples else None

    def keep_few(self) -> None:
        """Forget everything once there are too many answers."""
        if len(self.examples) + len(self.parents) > _MOST_KEPT:
            self.examples.clear()
            self.parents.clear()


def rule_of(names: DocumentNames, name: str) -> Rule | None:
    """A rule of the document after resolution; None if its rulebook has mistakes."""
    book = names.checked.resolved.rulebook
    return None if book is None else next((rule for rule in book.rules if rule.name == name), None)


def code_lenses(
    names: DocumentNames, positions: TextPositions, uri: str, known: KnownAnswers
) -> list[lsp.CodeLens]:
    """The lenses of a document's rules; they need a rulebook without mistakes."""
    lenses: list[lsp.CodeLens] = []
    for item in names.file.items:
        rule = rule_of(names, item.name.text) if isinstance(item, tree.RuleItem) else None
        if rule is None or not isinstance(item, tree.RuleItem):
            continue
        where = positions.of(item.name.span)
        for title, command in _of_rule(item, rule, names, known):
            arguments = [uri, rule.name] if command else None
            lenses.append(lsp.CodeLens(where, lsp.Command(title, command, arguments=arguments)))
    return lenses


def parent_key(rule: Rule, names: DocumentNames) -> tuple[Formula, tuple[str, ...]]:
    """The key of a rule's relation to its parent: its formula, and the texts of its bases."""
    return rule.formula, tuple(file.span.source.text for file in names.chain.books[:-1])


def _of_rule(
    item: tree.RuleItem, rule: Rule, names: DocumentNames, known: KnownAnswers
) -> Iterator[tuple[str, str]]:
    answer = known.of_examples(rule)
    number = len(rule.examples)
    if answer is None:
        yield f"run {number} examples" if number != 1 else "run 1 example", RUN
    elif answer.failing:
        yield f"{len(answer.failing)} of {number} examples fail", RUN
    else:
        yield "1 example passes" if number == 1 else f"{number} examples pass", RUN
    yield "in plain English", ENGLISH
    if len(names.chain.books) > 1 and item.override:
        yield _beside_parent(rule, names, known), COMPARE
    if answer is not None and answer.missing:
        edges = f"{len(answer.missing)} untested edge{'s' if len(answer.missing) > 1 else ''}"
        yield f"{edges}: insert the missing example", INSERT
    yield from _on_recordings(rule, answer)


def _beside_parent(rule: Rule, names: DocumentNames, known: KnownAnswers) -> str:
    parent = names.chain.books[-2].name
    answer = known.parents.get(parent_key(rule, names))
    if answer is not None:
        with_what = "" if answer.relation in ("equal", "undecided") else ": see a trace"
        says = "as strict as" if answer.relation == "equal" else f"{answer.relation} than"
        says = "neither stricter nor laxer than" if answer.relation == "incomparable" else says
        return f"{says} `{answer.parent}`{with_what}"
    return f"stricter or laxer than `{parent.text if parent else 'its parent'}`?"


def _on_recordings(rule: Rule, answer: ExampleAnswer | None) -> Iterator[tuple[str, str]]:
    if answer is not None:
        if answer.lacking:
            yield f"not judgeable from CommonRoad: lacks {', '.join(answer.lacking)}", ""
        return
    untold = [
        name
        for name in dict.fromkeys(names_in(rule.formula))
        if name not in TELLABLE_WORDS[COMMONROAD]
    ]
    if untold:
        yield f"CommonRoad does not tell {', '.join(untold)}", RUN


def inserted_example(names: DocumentNames, name: str, example: str) -> TextChange | None:
    """The change that adds an example at the end of a rule, before its closing brace."""
    for item in names.file.items:
        if isinstance(item, tree.RuleItem) and item.name.text == name:
            end = item.span.end - 1
            line = names.checked.text.rfind("\n", 0, end) + 1
            if names.checked.text[line:end].strip():
                return TextChange(end, end, f"\n  {example}\n")
            return TextChange(line, line, f"  {example}\n")
    return None


COMMONROAD = "commonroad"

_WIDTH = 100
"""The width of texts in characters."""


@dataclass(frozen=True, slots=True)
class ExampleAnswer:
    """The results of a rule's examples, and examples that are missing.

    ``lacking`` are the words without which CommonRoad's recordings cannot judge the rule.
    """

    passed: int
    failing: tuple[str, ...]
    missing: tuple[str, ...]
    lacking: tuple[str, ...]

    def in_words(self, rule: str) -> str:
        """One sentence each on examples, edges and recordings."""
        total = self.passed + len(self.failing)
        text = [f"{rule}: {self.passed} of {total} examples pass"]
        if self.failing:
            text.append(f"failing: {', '.join(self.failing)}")
        if self.missing:
            text.append(f"untested edges: {len(self.missing)}, the first one by\n{self.missing[0]}")
        if self.lacking:
            text.append(f"not judgeable from CommonRoad, which lacks {', '.join(self.lacking)}")
        return "\n".join(text)


@dataclass(frozen=True, slots=True)
class ParentAnswer:
    """A rule compared with that of the rulebook that this one extends, with a witness in words."""

    relation: str
    parent: str
    text: str


def example_answer(book: Rulebook, rule: Rule) -> ExampleAnswer:
    """Run the examples of a rule and find what they do not cover. Raises RulecError."""
    alone = replace(book, rules=(rule,))
    compiled = lazy.compile_rulebook(alone)
    run = lazy.run_rulebook_examples(alone, compiled)
    seen = lazy.example_coverage.coverage(run) if rule.examples else ()
    words = with_told_values(TELLABLE_WORDS[COMMONROAD], compiled.vocabulary)
    words |= lazy.told_types(COMMONROAD, compiled.vocabulary)
    audited = lazy.audit_source(compiled, COMMONROAD, words)
    return ExampleAnswer(
        sum(outcome.passed for outcome in run.outcomes),
        tuple(outcome.name for outcome in run.outcomes if not outcome.passed),
        tuple(
            example
            for witness in seen
            for example in lazy.missing_examples(witness, compiled.vocabulary)
        ),
        audited.rules[0].lacking,
    )


def english(book: Rulebook, rule: Rule) -> str:
    """A rule in plain English."""
    return lazy.rule_page.summary(rule, book, _WIDTH)


def parent_answer(book: Rulebook, parent: Rulebook, rule: str) -> ParentAnswer:
    """Whether a rule is stricter or laxer than its parent. Raises RulecError."""
    diff = lazy.diff_rulebooks(first=book, second=parent, patterns=(rule,))
    relation = diff.pairs[0].comparison.relation if diff.pairs else "of its own"
    return ParentAnswer(relation, parent.name, lazy.diff_text.as_text(diff, _WIDTH))
