"""Hover texts of names, in Markdown."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.analysis.audit.citations import cited_entries, listed_places
from rulec.diagnostics import Span
from rulec.language_server.names.name_occurrences import DocumentNames, NamedSymbol, Occurrence
from rulec.logic.printing import formula_text
from rulec.report.rulebooks.word_texts import (
    as_paragraphs,
    described,
    tells_words,
    type_text,
    word_text,
)
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.overlay.rulebook_overlay import Value, in_force
from rulec.syntax import tree
from rulec.syntax.tree_printer import print_formula, print_in_force, print_parameters


def hover_text(names: DocumentNames, occurrence: Occurrence) -> str:
    """Everything known about a name."""
    return "\n\n".join(filter(None, _parts(names, occurrence.symbol)))


def _parts(names: DocumentNames, symbol: NamedSymbol) -> Iterator[str]:
    laid, symbols = names.chain.names.constants.overlay, names.chain.names.symbols
    match symbol.kind:
        case "rule":
            yield from _rule(names, symbol.name)
        case "signal" | "quantity" | "enumeration" | "value":
            recorded = tells_words(names.chain.vocabularies)
            yield from as_paragraphs(word_text(symbol.name, symbols, recorded=recorded))
        case "type":
            yield from as_paragraphs(type_text(symbol.name, symbols))
        case "option":
            yield _code(f"option {symbol.name} = {'on' if laid.options[symbol.name] else 'off'}")
            yield from described(symbol.span)
            changed = laid.changed_at.get(symbol.name)
            if changed is not None:
                yield f"Set in {_file(names, changed.span)}."
        case "parameter":
            yield from _parameter(names, symbol)
        case "definition":
            item = laid.definitions[symbol.name]
            head = f"define {item.name.text}{print_parameters(item.parameters)}"
            yield _code(f"{head} =\n  {print_formula(item.body, 'written')}")
            yield from described(item.span)
        case "variable":
            kind = _type_of(names, symbol)
            yield _code(f"{symbol.name}: {kind}" if kind else symbol.name)
            known = names.chain.type(kind) if kind else None
            if known is not None:
                yield from described(known.span)
        case "level":
            yield f"Priority level `{symbol.name}`"
            higher, lower = _around(names, symbol.name)
            yield "; ".join(
                text
                for text in (
                    f"below {', '.join(higher)}" if higher else "",
                    f"above {', '.join(lower)}" if lower else "",
                )
                if text
            )
        case "topic":
            yield f"Topic: {laid.topics[symbol.name].title.value}"
        case "file":
            yield from _book(names, symbol)
    if symbol.span.source is not names.checked.source:
        yield f"*from {_file(names, symbol.span)}*"


def _code(text: str) -> str:
    return f"```rulec\n{text}\n```"


def _file(names: DocumentNames, span: Span) -> str:
    for file in (*names.chain.books, *names.chain.vocabularies):
        if file.span.source is span.source and file.name is not None:
            return f"{file.kind} `{file.name.text}`"
    return span.source.name


def _rule(names: DocumentNames, name: str) -> Iterator[str]:
    laid = names.chain.names.constants.overlay
    entry = laid.rules.get(name)
    if entry is None:
        yield f"Rule `{name}`, which this rulebook no longer has."
        return
    item = entry.item
    level = f" in {item.level.text}" if item.level else ""
    weight = f" weight {item.weight.text}" if item.weight else ""
    about = print_parameters(item.variables)
    yield _code(f"{item.strength or 'hard'} rule {name}{about}{level}{weight}")
    if item.says:
        yield item.says.value
    law = entry.law
    book = law.name.text if law.name is not None else ""
    if item.cite:
        heading = _heading(names, item.cite.value, book)
        yield f"**{item.cite.value}**{f', {heading}' if heading else ''}, law of `{book}`"
    if item.source:
        yield f"<{item.source.value}>" if "://" in item.source.value else item.source.value
    if item.in_force:
        yield f"{print_in_force(item.in_force).capitalize()}."
    if item.require is not None:
        yield _code(f"require {print_formula(item.require, 'written')}")


def _heading(names: DocumentNames, cite: str, law: str) -> str:
    """The heading of the first article that a rule cites, by the provisions of its own law."""
    headings = {
        entry.number.value: entry.heading.value
        for file, item in names.chain.names.constants.overlay.provisions
        if file.name is not None and file.name.text == law
        for entry in item.entries
    }
    found = next(cited_entries(cite, listed_places(headings)), "")
    return headings.get(found, "")


def _parameter(names: DocumentNames, symbol: NamedSymbol) -> Iterator[str]:
    constants = names.chain.names.constants
    values = constants.overlay.parameters[symbol.name]
    for value in values:
        item = value.item
        if isinstance(item, tree.ParamItem):
            kind = f" : {item.dimension.text}" if item.dimension else ""
            yield _code(f"param {symbol.name}{kind} = {print_formula(item.value, 'written')}")
            break
    yield from described(values[0].item.span)
    on_day = constants.numbers.get(symbol.name)
    if on_day is not None:
        yield f"On {constants.at}: **{value_text(on_day)}**"
    others = [value for value in values if not _holds(value, values, constants.at)]
    for value in others:
        yield f"Otherwise {_written(value)} ({_file(names, value.item.span)})"


def _holds(value: Value, values: list[Value], day: str) -> bool:
    good = [candidate for candidate in values if in_force(candidate.item.in_force, day)]
    return value in good and value.level == max(candidate.level for candidate in good)


def _written(value: Value) -> str:
    item = value.item
    assert not isinstance(item.value, bool), "only an option is on or off"
    when = print_in_force(item.in_force).removeprefix("in force") if item.in_force else ""
    return f"`{print_formula(item.value, 'written')}`{when}"


def value_text(number: NumberByCases) -> str:
    """A parameter's value as text, case by case, in the units that it was written in."""
    parts = []
    for conditions, linear in number.cases:
        when = " and ".join(map(formula_text, conditions))
        parts.append(f"{linear.text} if {when}" if when else linear.text)
    return "; ".join(parts)


def _type_of(names: DocumentNames, symbol: NamedSymbol) -> str:
    nodes = (node for item in names.chain.items_at(symbol) for node in tree.nodes_in(item))
    parameters = (node for node in nodes if isinstance(node, tree.Parameter))
    types = (x.type for x in parameters if x.name.span.start == symbol.span.start)
    return next((kind.text for kind in types if kind is not None), "")


def _around(names: DocumentNames, level: str) -> tuple[list[str], list[str]]:
    pairs = names.chain.names.priorities
    equal = {high for high, low in pairs if low == level and (low, high) in pairs}
    higher = sorted({high for high, low in pairs if low == level} - equal - {level})
    lower = sorted({low for high, low in pairs if high == level} - equal - {level})
    return higher, lower


def _book(names: DocumentNames, symbol: NamedSymbol) -> Iterator[str]:
    for file in (*names.chain.books, *names.chain.vocabularies):
        if file.span.source is symbol.span.source:
            yield f"**{file.kind} {symbol.name}**"
            if file.title is not None:
                yield file.title.text.value
            if file.law is not None:
                yield f"{file.law.text.value}, as of {file.law.as_of or 'no day'}"
