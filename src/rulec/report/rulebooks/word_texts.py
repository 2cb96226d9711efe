"""Texts about a word: its declaration, its meaning, and which sources provide it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rulec.diagnostics import Span, first_of
from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.report.json_document import JsonDocument, as_indented
from rulec.report.text import markdown
from rulec.report.text.terminal_text import broken, counted, visible
from rulec.rulebook.files.words_in_files import rules_reading
from rulec.rulebook.names.doc_comments import description
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.word_search import FoundWord, definition_in
from rulec.syntax import tree
from rulec.vocabulary import Declaration, Enumeration, Quantity

SUPPLIERS = {
    "Scene": "the scene: ego's own motion, and what is measured of others",
    "Map": "the map: the road, its marks and signs",
    "Interpretation": "whoever interprets the scene: what others are about to do, what traffic is "
    "like",
}
"""First word of a comment in the shared vocabulary -> what supplies the word declared."""

Readers = Mapping[str, Sequence[str]]
"""Rulebook -> the rules whose text reads a word."""

MOST_READERS = 6
"""The number of rules that are named as reading a word; JSON has all of them."""

RECORDED_VOCABULARIES = frozenset(("road", "paper"))
"""The vocabularies whose words recordings can provide."""


@dataclass(frozen=True, slots=True)
class WordText:
    """A word's declaration as in a rulebook, and sentences about it."""

    declaration: str
    sentences: tuple[str, ...]


class WordData(JsonDocument, frozen=True, kw_only=True):
    """A word: the file that declares it, its declaration, paragraphs about it, and who reads it.

    ``read_by`` has the rules of each rulebook whose own text reads it.
    """

    word: str
    declared_in: str
    declaration: str
    says: tuple[str, ...]
    read_by: Readers


def word_text(name: str, symbols: SymbolTable, *, recorded: bool) -> WordText:
    """The text about a signal, a quantity, an enumeration, or one of its values.

    ``recorded``: also name the formats of recordings that can provide it.
    """
    item = symbols.items.get(name) or symbols.value_of[name]
    sentences = [f"`{name}` is one of its values."] if name != item.name else []
    sentences += described(symbols.spans[item.name])
    remarks = [
        "it stays the same as long as a trace goes on" if item.constant else "",
        "where no source tells it, its default holds" if item.presumed else "",
    ]
    if any(remarks):
        sentence = "; ".join(filter(None, remarks))
        sentences.append(f"{sentence[0].upper()}{sentence[1:]}.")
    if recorded:
        sentences.append(_tellers(item.name))
    return WordText(_declared(item, symbols.spans[item.name]), tuple(sentences))


def type_text(name: str, symbols: SymbolTable) -> WordText:
    """The text about a type of objects."""
    above = symbols.ancestors(name)[1:]
    sentences = [*described(symbols.type_spans[name])]
    if above:
        sentences.append(f"Every {name} is also: {', '.join(above)}.")
    return WordText(f"type {name}" + (f" is {above[0]}" if above else ""), tuple(sentences))


def tells_words(vocabularies: Iterable[tree.File]) -> bool:
    """Whether words from these vocabularies, or files using them, may be found in recordings."""
    named = {file.name.text for file in vocabularies if file.name is not None}
    return not named.isdisjoint(RECORDED_VOCABULARIES)


def described(span: Span) -> Iterator[str]:
    """The comment on a declaration, and what supplies the declared word."""
    text = description(span)
    first, colon, rest = text.partition(": ")
    if colon and first in SUPPLIERS:
        yield rest[:1].upper() + rest[1:]
        yield f"Supplied by {SUPPLIERS[first]}."
    elif text:
        yield text


def _declared(item: Declaration, span: Span) -> str:
    """A declaration on one line, with the parameters' names that its comment uses."""
    parameters = re.compile(rf"\b{re.escape(item.name)}\s*(\([^()]*\))")
    written = parameters.search(span.source.text, span.start)
    about = f"({', '.join(item.parameters)})" if item.parameters else ""
    if written is not None and about:
        about = " ".join(written[1].split())
    match item:
        case Quantity():
            return f"quantity {item.name}{about} in {item.unit}{_default(item.default)}"
        case Enumeration():
            values = ", ".join(item.values)
            return f"{item.name}{about} is one of {values}{_default(item.default)}"
        case _:
            return f"signal {item.name}{about}{_default(item.default)}"


def as_text(word: FoundWord, readers: Readers, width: int) -> str:
    """The text about a word for a terminal."""
    text = _known(word)
    paragraphs = [
        f"{word.name}: {_kind_of(word)} of {_file_of(word)}",
        *map(visible, (*text.sentences, *_readers_in_words(readers))),
    ]
    head, *rest = (
        "\n".join(broken(paragraph, width, at_hyphens=False)) for paragraph in paragraphs
    )
    declaration = [
        part
        for line in text.declaration.splitlines()
        for part in broken(visible(line.strip()), width, _indent(line), f"{_indent(line)}  ")
    ]
    return "\n\n".join([head, "\n".join(declaration), *rest])


def _indent(line: str) -> str:
    return " " * (4 + len(line) - len(line.lstrip()))


def as_markdown(word: FoundWord, readers: Readers) -> str:
    """The text about a word as Markdown."""
    text = _known(word)
    head = f"# {markdown.escaped(word.name)}: {_kind_of(word)} of {_file_of(word)}"
    said = (markdown.escaped(sentence) for sentence in _readers_in_words(readers))
    return "\n\n".join([head, *as_paragraphs(text), *said])


def readers_of(word: FoundWord, search_path: Sequence[Path]) -> Readers:
    """The rules of each rulebook whose text reads a word, or a value of it."""
    declared = word.symbols.items.get(word.name)
    values = declared.values if isinstance(declared, Enumeration) else ()
    return rules_reading((word.name, *values), search_path)


def _readers_in_words(readers: Readers) -> Iterator[str]:
    counts = Counter(rule for rules in readers.values() for rule in rules).most_common()
    if counts:
        rules = [f"{rule} ({number})" if number > 1 else rule for rule, number in counts]
        yield (
            f"{counted(sum(map(len, readers.values())), 'rule')} in the texts of "
            f"{counted(len(readers), 'rulebook')} read it, also by definitions: "
            f"{first_of(rules, MOST_READERS)}."
        )


def as_paragraphs(text: WordText) -> Iterator[str]:
    """A word's declaration as code and the sentences about it, in Markdown."""
    yield markdown.fenced(text.declaration, "rulec")
    yield from text.sentences


def words_as_json(words: Iterable[tuple[FoundWord, Readers]]) -> str:
    """Write a list with an object for each word."""
    return as_indented([_data(*word) for word in words])


def _data(word: FoundWord, readers: Readers) -> WordData:
    text = _known(word)
    return WordData(
        word=word.name,
        declared_in=_file_of(word).replace("`", "").removeprefix("the "),
        declaration=text.declaration,
        says=text.sentences,
        read_by=readers,
    )


def _known(word: FoundWord) -> WordText:
    defined = definition_in(word.file, word.name)
    declared = word.symbols.items.get(word.name)
    if defined is not None and declared is not None:
        text = word_text(word.name, word.symbols, recorded=tells_words(word.vocabularies))
        means = "Where a source does not tell it, it means what it is defined as."
        both = f"{text.declaration}\n{defined.span.text}"
        return WordText(both, (*text.sentences, means, *described(defined.span)))
    if defined is not None:
        place = defined.span.place
        where = f"It stands in {place.file}, line {place.line}."
        return WordText(defined.span.text, (*described(defined.span), where))
    if word.name in word.symbols.types:
        return type_text(word.name, word.symbols)
    return word_text(word.name, word.symbols, recorded=tells_words(word.vocabularies))


def _file_of(word: FoundWord) -> str:
    return f"the {word.file.kind} `{word.file.name.text if word.file.name else ''}`"


def _kind_of(word: FoundWord) -> str:
    match None if word.name in word.symbols.items else definition_in(word.file, word.name):
        case tree.DefineItem():
            return "a definition"
        case tree.ParamItem():
            return "a parameter"
        case tree.OptionItem():
            return "an option"
        case _:
            return "a word"


def _default(value: float | str | bool | None) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return f" default {'true' if value else 'false'}"
    return f" default {value:g}" if isinstance(value, float) else f" default {value}"


def _tellers(name: str) -> str:
    formats = sorted(form for form, words in TELLABLE_WORDS.items() if name in words)
    if not formats:
        return "No format of recordings provides it."
    if len(formats) == len(TELLABLE_WORDS):
        return "Recordings of every format can provide it."
    return f"Recordings that can provide it: {', '.join(formats)}."
