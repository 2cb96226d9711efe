"""Commands of code lenses."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from lsprotocol import types as lsp

from rulec.diagnostics import RulecError
from rulec.language_server.editor_session import EditorSession
from rulec.language_server.lenses import code_lenses as lenses
from rulec.language_server.lenses.rule_answers import (
    ExampleAnswer,
    english,
    example_answer,
    parent_answer,
)
from rulec.language_server.names.document_names import DocumentNames
from rulec.language_server.names.renaming import workspace_edit
from rulec.rulebook.reading.rulebook_reader import read_rulebook
from rulec.rulebook.rulebook_model import Rule, Rulebook


def add_commands(server: EditorSession) -> None:
    """Register the commands of code lenses; each takes a document and a rule's name.

    Compilation runs in the background, so that typing goes on. Answers are shown and returned.
    """

    def command(name: str) -> Callable[[_Ask], None]:
        """Register what a command asks; a reason why it has no answer is shown, too."""

        def registered(ask: _Ask) -> None:
            @server.command(name)
            async def asked(uri: str, rule: str) -> str:
                try:
                    return await ask(uri, rule)
                except (_NoAnswerError, RulecError) as reason:
                    return _shown(server, str(reason))

        return registered

    @command(lenses.RUN)
    async def run(uri: str, rule: str) -> str:
        answer = await _examples(server, _rule_asked_about(server, uri, rule))
        return _shown(server, answer.in_words(rule))

    @command(lenses.ENGLISH)
    async def in_english(uri: str, rule: str) -> str:
        _, book, of_rule = _rule_asked_about(server, uri, rule)
        return _shown(server, await asyncio.to_thread(english, book, of_rule))

    @command(lenses.COMPARE)
    async def compare(uri: str, rule: str) -> str:
        names, book, of_rule = _rule_asked_about(server, uri, rule)
        if len(names.chain.books) < 2:
            raise _NoAnswerError("the rulebook extends no other")
        above = names.chain.books[-2].span.source.name
        with server.editor.as_shown():
            parent = read_rulebook(above, (), book.at, book.traffic).rulebook
        answer = await asyncio.to_thread(parent_answer, book, parent, rule)
        server.answers.keep_few()
        server.answers.parents[lenses.parent_key(of_rule, names)] = answer
        server.refresh_lenses()
        return _shown(server, answer.text)

    @command(lenses.INSERT)
    async def insert(uri: str, rule: str) -> str:
        await _examples(server, _rule_asked_about(server, uri, rule))
        # Typing goes on meanwhile: the place is that in the text of now.
        names, _, of_rule = _rule_asked_about(server, uri, rule)
        answer = server.answers.of_examples(of_rule)
        if answer is None:
            raise _NoAnswerError(f"{rule} has been changed meanwhile: ask again")
        missing = answer.missing[0] if answer.missing else ""
        change = lenses.inserted_example(names, rule, missing) if missing else None
        if not of_rule.examples:
            raise _NoAnswerError(f"{rule} has no example: `rulec show` proposes the first ones")
        if change is None:
            raise _NoAnswerError(f"{rule}: every edge is tested")
        if not _takes_edits(server):
            return _shown(server, missing)
        edit = workspace_edit({uri: [change]}, server.editor)
        await server.workspace_apply_edit_async(lsp.ApplyWorkspaceEditParams(edit))
        return missing


class _NoAnswerError(Exception):
    """Why a command has no answer."""


_Ask = Callable[[str, str], Awaitable[str]]
"""Answers about a document, by its address, and a rule's name."""

RuleInDocument = tuple[DocumentNames, Rulebook, Rule]


def _rule_asked_about(server: EditorSession, uri: str, name: str) -> RuleInDocument:
    """A document, its rulebook and a rule in it. Raises _NoAnswerError if there are none."""
    known = server.names(uri)
    resolved = None if known is None else known[0].checked.resolved
    if known is None or resolved is None or resolved.rulebook is None:
        raise _NoAnswerError("the rulebook has mistakes: fix them first")
    names, _ = known
    rule = lenses.rule_of(names, name)
    if rule is None:
        raise _NoAnswerError(f"the rulebook has no rule `{name}`")
    return names, resolved.rulebook, rule


async def _examples(server: EditorSession, subject: RuleInDocument) -> ExampleAnswer:
    _, book, rule = subject
    answer = await asyncio.to_thread(example_answer, book, rule)
    server.answers.keep_few()
    server.answers.examples[rule.formula] = rule.examples, answer
    server.refresh_lenses()
    return answer


def _takes_edits(server: EditorSession) -> bool:
    workspace = server.client_capabilities.workspace
    return bool(workspace and workspace.apply_edit)


def _shown(server: EditorSession, text: str) -> str:
    server.window_show_message(lsp.ShowMessageParams(lsp.MessageType.Info, text))
    return text
