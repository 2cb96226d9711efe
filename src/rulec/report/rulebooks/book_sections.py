"""Last sections of the document for lawyers: provisions, omissions, vocabulary."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rulec.analysis.audit.rulebook_audit import used_declarations
from rulec.analysis.lineage.rule_lineage import BookLineage, ConstantHistory
from rulec.logic.english.atom_phrases import listed, spoken
from rulec.logic.printing import formula_text
from rulec.report.rulebooks.book_rule import WIDTH
from rulec.report.text.formula_lines import formula_lines
from rulec.report.text.markdown import Block, Heading, code, escaped, fenced, table
from rulec.rulebook.loader import Loaded
from rulec.rulebook.names.doc_comments import description
from rulec.rulebook.overlay.rulebook_overlay import in_force
from rulec.syntax import tree
from rulec.syntax.tree_printer import print_in_force
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal


def values_section(inherited: BookLineage, at: str) -> Iterator[Block]:
    """Options and parameters that rules speak of, with all their values."""
    rows = [
        row
        for provision in inherited.provisions
        if provision.kind != "definition" and provision.used
        for row in _values(provision)
    ]
    if rows:
        yield Heading(2, "Options and parameters")
        yield f"The value that counts on {at} is the one with a mark."
        head = ["name", "kind", "value", "counts", "in force", "given by", "note"]
        yield table(head, rows)


def _values(constant_history: ConstantHistory) -> Iterator[list[str]]:
    for setting in constant_history.settings:
        dates = print_in_force(tree.InForce(setting.since, setting.until))
        yield [
            code(constant_history.name),
            constant_history.kind,
            code(setting.text),
            "✔" if setting.current else "",
            dates.removeprefix("in force").strip() or "always",
            code(setting.book),
            escaped(setting.note),
        ]


def definitions_section(inherited: BookLineage) -> Iterator[Block]:
    """Definitions that rules use, with final and earlier meanings."""
    definitions = [
        provision
        for provision in inherited.provisions
        if provision.kind == "definition" and provision.used
    ]
    if definitions:
        yield Heading(2, "Definitions")
    for definition in definitions:
        *earlier, last = definition.settings
        before = [f"in {code(setting.book)} {code(setting.text)}" for setting in earlier]
        was = f" It was {listed(before)}." if before else ""
        note = f" {escaped(last.note)}" if last.note else ""
        yield f"{code(definition.name)} is defined by {code(last.book)}.{was}{note}"
        yield fenced("\n".join(_definition(definition.head, last.text)), "rulec")


def _definition(head: str, text: str) -> list[str]:
    """On one line, or its meaning below."""
    whole = f"define {head} = {text}"
    if len(whole) <= WIDTH:
        return [whole]
    return [f"define {head} =", *(f"  {line}" for line in formula_lines(text, WIDTH - 2))]


def left_out_section(inherited: BookLineage, at: str) -> Iterator[Block]:
    """Topics left out of the rulebook, with reasons."""
    rows = list(_left_out(inherited, at))
    if rows:
        yield Heading(2, "What this rulebook leaves out")
        yield table(["rule or topic", "what happened", "why"], rows)


def _left_out(inherited: BookLineage, at: str) -> Iterator[list[str]]:
    for rule in inherited.rules:
        last = rule.last
        if last.deed == "dropped":
            yield [code(rule.name), f"dropped by {code(last.book)}", escaped(last.because)]
        elif last.deed == "silent":
            yield [code(rule.name), f"{code(last.book)} is silent on it", escaped(last.because)]
        elif rule.rule is not None and not in_force(rule.rule.in_force, at):
            assert rule.rule.in_force is not None, "what has no dates is in force"
            dates = print_in_force(rule.rule.in_force)
            yield [code(rule.name), f"not in force on {at}", dates]


def words_section(loaded: Loaded) -> Iterator[Block]:
    """Words of the vocabulary that the rules use, and axioms."""
    rulebook = loaded.rulebook
    used = used_declarations(rulebook)
    described = _descriptions(loaded)
    rows = [
        [code(name), _about(word), _kind(word), escaped(described.get(name, ""))]
        for name, word in rulebook.vocabulary.declarations.items()
        if name in used
    ]
    if rows:
        yield Heading(2, "Vocabulary")
        yield "What the rules speak of, and what it can be; the default is in parentheses."
        yield table(["word", "is about", "what it can be", "description"], rows)
    if rulebook.axioms:
        yield Heading(2, "What always holds")
        yield "Whatever the rules say, this is so in every state:"
        axioms = [f"fact {formula_text(axiom.formula)}" for axiom in rulebook.axioms]
        yield fenced("\n".join(axioms), "rulec")


def _descriptions(loaded: Loaded) -> Mapping[str, str]:
    result: dict[str, str] = {}
    for file in (*loaded.vocabularies, *loaded.books):
        for item in file.items:
            match item:
                case tree.SignalItem(signals=signals):
                    result |= {signal.name.text: description(item.span) for signal in signals}
                case tree.EnumerationItem(name=name) | tree.QuantityItem(name=name):
                    result[name.text] = description(item.span)
    return result


def _about(item: Declaration) -> str:
    if not item.parameters:
        return "the world"
    return f"every {' and '.join(code(spoken(parameter)) for parameter in item.parameters)}"


def _kind(item: Declaration) -> str:
    match item:
        case Enumeration(values=values, default=default):
            shown = [f"({code(value)})" if value == default else code(value) for value in values]
            return f"one of {listed(shown)}"
        case Signal(default=default):
            return {None: "yes or no", True: "(yes) or no", False: "yes or (no)"}[default]
        case Quantity(unit=unit, default=default):
            usual = "" if default is None else f" ({repr(default).removesuffix('.0')})"
            return f"a number of {code(unit)}{usual}"
