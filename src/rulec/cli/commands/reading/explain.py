"""``rulec explain``: the meaning of a message's code, or of a word of a vocabulary."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.commands.traffic.find import moments_of
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.recording_options import TrafficOptions, traffic_options
from rulec.cli.options.shell_completion import complete_codes
from rulec.cli.options.verb_class import argument, option, verb
from rulec.cli.output import answer_lines, put_answer, width_of
from rulec.cli.verb_table import FORMER, VERBS
from rulec.diagnostics import any_of, first_of, nearest_name
from rulec.logic.formula import Atom
from rulec.recordings.recording_inputs import STANDARD_INPUT, input_files
from rulec.report.findings.code_registry import CodeExplanation, all_codes, as_sections
from rulec.report.findings.diagnostics_text import Complaints
from rulec.report.text.console import print_remark
from rulec.rulebook.batch.answer_cache import AnswerQuestion
from rulec.rulebook.files.search_path import available_files, available_rulebooks
from rulec.rulebook.files.source_walk import SUFFIX
from rulec.settings import search_path

_ALIKE = 0.75
"""As for names in formulas: less similar words are seldom slips, such as `trikk` for `truck`."""

_SLIP = 3
"""The most letters by which a misspelt definition is longer or shorter."""


@verb
def command(
    *,
    names: tuple[str, ...] = argument(
        nargs=-1, metavar="[CODE|WORD]... [FILE]...", shell_complete=complete_codes
    ),
    every: bool = option("--all", is_flag=True, help="Explain every code."),
    traffic: TrafficOptions = traffic_options,
    rulebook: str | None = shared.rulebook_option(
        "a word has the meaning of one rulebook",
        "The rulebook (name or source) by which a WORD is read in FILE...  [default: road's own "
        "words]",
        required=False,
    ),
    to: Output = output_options(
        endings_of("full", "json", "markdown"),
        "the explanation: text, JSON or Markdown",
    ),
) -> int:
    """Explain each CODE, such as R0104: what it means, with a bad example and its correction.

    For a WORD of a vocabulary, such as `gap`, show how it is declared, what it means, which
    recordings provide it, and which rules read it; for a definition or a parameter of a rulebook,
    its text and its place. Vocabularies and rulebooks in the working folder are searched, too.

    With FILE..., recorded traffic or traces, show the values of the first WORD there, drive by
    drive, and where they are not known.
    """
    if every == bool(names):
        raise click.UsageError("give a code or a word, such as `R0104` or `gap`, or --all")
    if any(map(_is_of_files, names[1:])):
        return _shown_values(names, rulebook or "", to, traffic)
    if traffic.egos or rulebook:
        raise click.UsageError("`--ego` and `-r` are for the values of a word in a FILE")
    question = ("explain", *names, repr((every, to.form, width_of(to))))
    explained = partial(_explained, names, to.form, width_of(to), every=every)
    text, unknown = AnswerQuestion(question, _places()).answer(explained)
    put_answer(text, to)
    for name in unknown:
        print_remark(f"rulec: {_unknown(name)}")
    return ExitStatus.after(answered=not unknown, failed=False)


def _is_of_files(name: str) -> bool:
    """Whether a name is one of files, which codes and words are not."""
    return name == STANDARD_INPUT or any(map(name.count, "./*?[")) or os.path.lexists(name)


def _shown_values(
    names: tuple[str, ...], rulebook: str, to: Output, traffic: TrafficOptions
) -> int:
    """Show the values of a word in files."""
    word, inputs = names[0], input_files(names[1:])
    complaints = Complaints(inputs.problems)
    query = lazy.read_query("true", rulebook=rulebook, search_path=search_path())
    known = {**query.vocabulary.enumeration_of, **query.vocabulary.declarations}
    if word not in known:
        raise click.UsageError(_unknown(word))
    word = known[word].name
    query = replace(query, rule=replace(query.rule, formula=Atom(word)))
    as_text = partial(lazy.word_values.lines, name=word, width=width_of(to))
    lines_of = lazy.word_values.json_lines if to.form == "json" else as_text
    with answer_lines(to) as write:
        look = partial(lazy.word_values.word_spans, name=word)
        for drive in moments_of(query, inputs.paths, traffic, complaints, look):
            for line in lines_of(drive):
                write(line)
    complaints.close()
    return ExitStatus.after(answered=not complaints, failed=False)


def _explained(
    names: Sequence[str], form: str, width: int, *, every: bool
) -> tuple[tuple[str, tuple[str, ...]], Sequence[str]]:
    """The explanation and the unknown names, and the files that words were searched in."""
    by_name = {name: all_codes().get(name.upper()) for name in names}
    words = {name: _words(name) for name, code in by_name.items() if code is None}
    unknown = tuple(name for name, found in words.items() if not found)
    if unknown and len(unknown) == len(by_name):
        raise click.UsageError("\n".join(map(_unknown, unknown)))
    codes = [code for code in by_name.values() if code is not None]
    codes = list(dict.fromkeys(codes)) if names else [*all_codes().values()]
    found_words = [word for words_of_name in words.values() for word in words_of_name]
    match form:
        case "json":
            text = _as_json(codes, found_words)
        case "markdown" if every:
            text = f"# Codes\n\n{as_sections()}"
        case "markdown":
            pages = [f"# {code.code}: {code.title}\n\n{code.markdown}" for code in codes]
            text = "\n\n".join([*pages, *_texts(found_words, None)])
        case _:
            pages = [code.as_text(width) for code in codes]
            text = "\n\n\n".join([*pages, *_texts(found_words, width)])
    return (text, unknown), available_files(_places()) if words else ()


def _words(name: str) -> Sequence[lazy.FoundWord]:
    return lazy.find_word(name, _places())


def _places() -> tuple[Path, ...]:
    """The search path and, last, the working folder, beside whose rulebooks words may lie."""
    return (*search_path(), Path())


def _unknown(name: str) -> str:
    return f"there is no code and no word `{name}`; {_way_out(name)}"


def _texts(words: Sequence[lazy.FoundWord], width: int | None) -> list[str]:
    """The texts about words, of a width, or as Markdown for None."""
    if not words:
        return []
    read = [(word, lazy.readers_of(word, _places())) for word in words]
    return [
        lazy.word_texts.as_markdown(*one) if width is None else lazy.word_texts.as_text(*one, width)
        for one in read
    ]


def _as_json(codes: Sequence[CodeExplanation], words: Sequence[lazy.FoundWord]) -> str:
    if words:
        if codes:
            raise click.UsageError("as JSON codes and words are two lists; ask for either")
        return lazy.words_as_json((word, lazy.readers_of(word, _places())) for word in words)
    return lazy.codes_as_json(codes)


def _way_out(name: str) -> str:
    """Where another thing of this name is explained, or a code or word that may be meant."""
    places = _places()
    if Path(name).suffix == SUFFIX and Path(name).is_file():
        return f"it is a file, which `rulec show {name}` explains"
    if name in VERBS or name in FORMER:
        return f"it is a command, which `rulec help {name}` explains"
    if near := nearest_name(name.upper(), all_codes()):
        return f"did you mean `{near}`?"
    if name in available_rulebooks(places):
        return f"it is a rulebook, which `rulec show {name}` explains"
    if books := lazy.rulebooks_with_rule(name, places):
        more = f" (also of {first_of(books[1:], 3)})" if books[1:] else ""
        return f"it is a rule, which `rulec show {books[0]} {name}` explains{more}"
    topics = lazy.words_in_files.topics_of_rulebooks(places)
    if name in topics:
        of = f" of rules such as {any_of([f'`{rule}`' for rule in topics[name]])}"
        topic = f"it is a topic{of if topics[name] else ''}"
        return f"{topic}: `rulec list rules --topic {name}` shows who has rules on it"
    words = lazy.words_in_files.words_of_vocabularies(places)
    known = sorted(frozenset[str]().union(*words.values()))
    defined = frozenset[str]().union(*lazy.words_in_files.definitions_of_rulebooks(places).values())
    as_long = sorted(one for one in defined if abs(len(one) - len(name)) <= _SLIP)
    kinds = {
        "did you mean the word `{}`?": known,
        "did you mean the rule `{}`?": sorted(lazy.words_in_files.rules_of_rulebooks(places)),
        "did you mean the topic `{}`?": topics,
        "did you mean `{}`, which a rulebook defines?": as_long,
        "did you mean the command `{0}`, which `rulec help {0}` explains?": VERBS,
    }
    meant = {
        near: text
        for text, names in reversed(kinds.items())
        if (near := nearest_name(name, names, _ALIKE))
    }
    if meant:
        near = nearest_name(name, meant, _ALIKE) or next(reversed(meant))
        return meant[near].format(near)
    return str(lazy.word_meanings.offer(name, lazy.word_meanings.described(known, words))) or (
        "`rulec list codes` shows all codes, and `rulec list vocabularies` the files with words"
    )
