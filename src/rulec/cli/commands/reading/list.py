"""``rulec list``: the available rulebooks, vocabularies, scenarios and codes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Literal, get_args

import click

import rulec
from rulec.api.rulebook_questions import Kind
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.shared_options import rules_on_topic
from rulec.cli.options.verb_class import argument, verb
from rulec.cli.output import errors_told, open_session, put_answer, sources_of_rulebooks, width_of
from rulec.rulebook.batch.answer_cache import AnswerQuestion
from rulec.rulebook.files.search_path import available_rulebooks
from rulec.settings import search_path

KINDS: tuple[Kind, ...] = get_args(Kind)


@verb
def command(
    *,
    kind: Kind | Literal["rules"] | None = argument(
        type=click.Choice([*KINDS, "rules", "formats"]), required=False
    ),
    rulebooks: tuple[str, ...] = shared.rulebooks_argument("[RULEBOOK]...", required=False),
    to: Output = output_options(endings_of("text", "json"), "the list"),
    topic: str | None = shared.topic_option("With `rules`: list only those on a topic"),
    at: str = shared.at_option,
) -> int:
    """List everything that can be named, with its title; without KIND all kinds except codes.

    `rules` are those of RULEBOOKs, by default of all: by topic, with the books that have each.
    `formats`, of recorded traffic and maps, have options of their own: `rulec help list formats`.

    Exit status: 0 done, 2 a rulebook could not be read.
    """
    if kind == "rules":
        width = 0 if to.form == "json" else width_of(to)
        question = AnswerQuestion(("list", *rulebooks, repr((topic, at, width))), search_path())
        text, is_complete = question.answer(partial(_rules, rulebooks, topic, at, width))
        put_answer(text, to)
        return ExitStatus.after(answered=is_complete, failed=False)
    if rulebooks or topic or at:
        raise click.UsageError("only rules are those of a RULEBOOK: `rulec list rules de`")

    def session(kind: Kind) -> rulec.Session:
        # Scenarios and codes are listed even if the project's settings have a mistake.
        return open_session() if kind in ("rulebooks", "vocabularies") else rulec.Session()

    kinds = KINDS[:-1] if kind is None else (kind,)
    lists: dict[str, Sequence[lazy.Listed]] = {kind: session(kind).list(kind) for kind in kinds}
    put_answer(
        lazy.listing.as_json(lists)
        if to.form == "json"
        else lazy.listing.as_text(lists, width_of(to)),
        to,
    )
    return ExitStatus.OK


def _rules(
    rulebooks: Sequence[str], topic: str | None, at: str, width: int
) -> tuple[tuple[str, bool], Sequence[str]]:
    """The rules of rulebooks as text of a width, or JSON if that is 0.

    Also whether all could be read, and if so the files.
    """
    named = sources_of_rulebooks(rulebooks, "has no list") or available_rulebooks(search_path())
    read = []
    for name in named:
        with errors_told():
            read.append(lazy.read_rulebook(name, search_path(), at))
    is_complete = len(read) == len(named)
    books = [loaded.rulebook for loaded in read if loaded.rulebook.rules]
    books = books if topic is None else [*rules_on_topic(books, topic)]
    text = lazy.rule_list.as_text(books, width, "") if width else lazy.rule_list.as_json(books)
    paths = [path for loaded in read for path in loaded.sources] if is_complete else []
    return (text, is_complete), paths
