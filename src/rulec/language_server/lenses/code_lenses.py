"""Code lenses above rules: questions about each, and their answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from lsprotocol import types as lsp

from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.language_server.lenses.rule_answers import COMMONROAD, ExampleAnswer, ParentAnswer
from rulec.language_server.names.document_names import DocumentNames
from rulec.language_server.names.renaming import TextChange
from rulec.language_server.workspace.text_positions import TextPositions
from rulec.logic.formula import Formula
from rulec.logic.free_names import names_in
from rulec.rulebook.rulebook_model import Example, Rule
from rulec.syntax import tree

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
    resolved = names.checked.resolved
    book = None if resolved is None else resolved.rulebook
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
        where = positions.range(*names.bounds(item.name.span))
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
            end = names.bounds(item.span)[1] - 1
            line = names.checked.text.rfind("\n", 0, end) + 1
            if names.checked.text[line:end].strip():
                return TextChange(end, end, f"\n  {example}\n")
            return TextChange(line, line, f"  {example}\n")
    return None
