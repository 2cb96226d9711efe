"""What stands behind the rules in a document for lawyers: provisions, what is left out, words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rulec.analysis.lineage.rule_lineage import BookLineage, ConstantHistory
from rulec.analysis.vocabulary_use import used_declarations
from rulec.logic.english.atom_phrases import listed, spoken
from rulec.logic.printing import formula_text
from rulec.report.rulebooks.book_rule import WIDTH
from rulec.report.text.formula_lines import formula_lines
from rulec.report.text.markdown import Block, Heading, code, escaped, fenced, table
from rulec.rulebook.loader import Loaded
from rulec.rulebook.model import Rulebook
from rulec.rulebook.names.doc_comments import description
from rulec.rulebook.overlay.constants_and_macros import in_force
from rulec.syntax import tree
from rulec.syntax.tree_printer import print_in_force
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal


def values_section(inherited: BookLineage, at: str) -> Iterator[Block]:
    """Options and parameters that rules speak of, with all their values."""
    found = [one for one in inherited.provisions if one.kind != "definition" and one.used]
    if not found:
        return
    yield Heading(2, "Options and parameters")
    yield f"The value that counts on {at} is the one with a mark."
    head = ["name", "kind", "value", "counts", "in force", "given by", "note"]
    yield table(head, (row for one in found for row in _values(one)))


def _values(one: ConstantHistory) -> Iterator[list[str]]:
    for setting in one.settings:
        dates = print_in_force(tree.InForce(setting.since, setting.until))
        yield [
            code(one.name),
            one.kind,
            code(setting.text),
            "✔" if setting.current else "",
            dates.removeprefix("in force").strip() or "always",
            code(setting.book),
            escaped(setting.note),
        ]


def definitions_section(inherited: BookLineage) -> Iterator[Block]:
    """Definitions that rules speak of, as they are in the end, and what they were before."""
    found = [one for one in inherited.provisions if one.kind == "definition" and one.used]
    if not found:
        return
    yield Heading(2, "Definitions")
    for one in found:
        last = one.settings[-1]
        before = [f"in {code(each.book)} {code(each.text)}" for each in one.settings[:-1]]
        was = f" It was {listed(before)}." if before else ""
        note = f" {escaped(last.note)}" if last.note else ""
        yield f"{code(one.name)} is defined by {code(last.book)}.{was}{note}"
        yield fenced("\n".join(_definition(one.head, last.text)), "rulec")


def _definition(head: str, text: str) -> list[str]:
    """On one line, or its meaning below."""
    whole = f"define {head} = {text}"
    if len(whole) <= WIDTH:
        return [whole]
    return [f"define {head} =", *(f"  {line}" for line in formula_lines(text, WIDTH - 2))]


def left_out_section(inherited: BookLineage, at: str) -> Iterator[Block]:
    """What is not in the rulebook, and why."""
    rows = list(_left_out(inherited, at))
    if rows:
        yield Heading(2, "What this rulebook leaves out")
        yield table(["rule or topic", "what happened", "why"], rows)


def _left_out(inherited: BookLineage, at: str) -> Iterator[list[str]]:
    for one in inherited.rules:
        last = one.last
        if last.deed == "dropped":
            yield [code(one.name), f"dropped by {code(last.book)}", escaped(last.because)]
        elif last.deed == "silent":
            yield [code(one.name), f"{code(last.book)} is silent on it", escaped(last.because)]
        elif one.rule is not None and not in_force(one.rule.in_force, at):
            assert one.rule.in_force is not None, "what has no dates is in force"
            dates = print_in_force(one.rule.in_force)
            yield [code(one.name), f"not in force on {at}", dates]


def words_section(loaded: Loaded) -> Iterator[Block]:
    """The words of the vocabulary that the rules use, and what always holds."""
    rulebook = loaded.rulebook
    used = used_declarations(rulebook)
    found = [one for name, one in rulebook.vocabulary.declarations.items() if name in used]
    if found:
        described = _descriptions(loaded)
        yield Heading(2, "Vocabulary")
        yield "What the rules speak of, and what it can be; the default is in parentheses."
        rows = (
            [code(one.name), _about(one), _kind(one), escaped(described.get(one.name, ""))]
            for one in found
        )
        yield table(["word", "is about", "what it can be", "description"], rows)
    yield from _facts(rulebook)


def _facts(rulebook: Rulebook) -> Iterator[Block]:
    if rulebook.axioms:
        yield Heading(2, "What always holds")
        yield "Whatever the rules say, this is so in every state:"
        yield fenced(
            "\n".join(f"fact {formula_text(one.formula)}" for one in rulebook.axioms), "rulec"
        )


def _descriptions(loaded: Loaded) -> Mapping[str, str]:
    found: dict[str, str] = {}
    for file in (*loaded.vocabularies, *loaded.books):
        for item in file.items:
            match item:
                case tree.SignalItem(signals=signals):
                    found |= {one.name.text: description(item.span) for one in signals}
                case tree.EnumerationItem(name=name) | tree.QuantityItem(name=name):
                    found[name.text] = description(item.span)
    return found


def _about(item: Declaration) -> str:
    if not item.parameters:
        return "the world"
    return f"every {' and '.join(code(spoken(one)) for one in item.parameters)}"


def _kind(item: Declaration) -> str:
    match item:
        case Enumeration(values=values, default=default):
            shown = [f"({code(one)})" if one == default else code(one) for one in values]
            return f"one of {listed(shown)}"
        case Signal(default=default):
            return {None: "yes or no", True: "(yes) or no", False: "yes or (no)"}[default]
        case Quantity(unit=unit, default=default):
            usual = "" if default is None else f" ({repr(default).removesuffix('.0')})"
            return f"a number of {code(unit)}{usual}"
