"""Commands of code lenses."""

from __future__ import annotations

import asyncio

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

    @server.command(lenses.RUN)
    async def run(uri: str, rule: str) -> str:
        subject = _rule_asked_about(server, uri, rule)
        if isinstance(subject, str):
            return _shown(server, subject)
        answer = await _examples(server, subject)
        return _shown(server, answer if isinstance(answer, str) else answer.in_words(rule))

    @server.command(lenses.ENGLISH)
    async def in_english(uri: str, rule: str) -> str:
        subject = _rule_asked_about(server, uri, rule)
        if isinstance(subject, str):
            return _shown(server, subject)
        _, book, of_rule = subject
        return _shown(server, await asyncio.to_thread(english, book, of_rule))

    @server.command(lenses.COMPARE)
    async def compare(uri: str, rule: str) -> str:
        subject = _rule_asked_about(server, uri, rule)
        if isinstance(subject, str):
            return _shown(server, subject)
        if len(subject[0].chain.books) < 2:
            return _shown(server, "the rulebook extends no other")
        names, book, of_rule = subject
        above = names.chain.books[-2].span.source.name
        try:
            with server.editor.as_shown():
                parent = read_rulebook(above, (), book.at, book.traffic).rulebook
            answer = await asyncio.to_thread(parent_answer, book, parent, rule)
        except RulecError as error:
            return _shown(server, str(error))
        server.answers.keep_few()
        server.answers.parents[lenses.parent_key(of_rule, names)] = answer
        server.refresh_lenses()
        return _shown(server, answer.text)

    @server.command(lenses.INSERT)
    async def insert(uri: str, rule: str) -> str:
        subject = _rule_asked_about(server, uri, rule)
        if isinstance(subject, str):
            return _shown(server, subject)
        found = await _examples(server, subject)
        if isinstance(found, str):
            return _shown(server, found)
        # Typing goes on meanwhile: the place is that in the text of now.
        subject = _rule_asked_about(server, uri, rule)
        if isinstance(subject, str):
            return _shown(server, subject)
        names, _, of_rule = subject
        answer = server.answers.of_examples(of_rule)
        if answer is None:
            return _shown(server, f"{rule} has been changed meanwhile: ask again")
        missing = answer.missing[0] if answer.missing else ""
        change = lenses.inserted_example(names, rule, missing) if missing else None
        if not of_rule.examples:
            return _shown(server, f"{rule} has no example: `rulec show` proposes the first ones")
        if change is None:
            return _shown(server, f"{rule}: every edge is tested")
        if not _takes_edits(server):
            return _shown(server, missing)
        edit = workspace_edit({uri: [change]}, server.editor)
        await server.workspace_apply_edit_async(lsp.ApplyWorkspaceEditParams(edit))
        return missing


_MISTAKES = "the rulebook has mistakes: fix them first"

RuleInDocument = tuple[DocumentNames, Rulebook, Rule]


def _rule_asked_about(server: EditorSession, uri: str, name: str) -> RuleInDocument | str:
    """A document, its rulebook and a rule in it, or the reason why they are not available."""
    known = server.names(uri)
    if known is None:
        return _MISTAKES
    names, _ = known
    resolved = names.checked.resolved
    if resolved is None or resolved.rulebook is None:
        return _MISTAKES
    rule = lenses.rule_of(names, name)
    if rule is None:
        return f"the rulebook has no rule `{name}`"
    return names, resolved.rulebook, rule


async def _examples(server: EditorSession, subject: RuleInDocument) -> ExampleAnswer | str:
    _, book, rule = subject
    try:
        answer = await asyncio.to_thread(example_answer, book, rule)
    except RulecError as error:
        return str(error)
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
