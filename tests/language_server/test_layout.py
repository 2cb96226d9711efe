"""Formatting, outline and folding."""

from lsprotocol import types as lsp

import rulec
from support.editor import shown

BOOK = """\
# one
# two
rulebook laid
signal p,q
param most : time = 3 s
hard rule r {
  cite "Art. 1"   require always (p or q)
  accept "calm" { p }
}
"""


def params(editor, kind, name, **more):
    return kind(text_document=lsp.TextDocumentIdentifier(editor.uri(name)), **more)


def test_formatting_is_that_of_the_command(editor):
    editor.open("laid.rules", BOOK)
    options = lsp.FormattingOptions(tab_size=2, insert_spaces=True)
    asked = params(editor, lsp.DocumentFormattingParams, "laid.rules", options=options)
    (edit,) = editor.ask(lsp.TEXT_DOCUMENT_FORMATTING, asked)
    assert shown(BOOK, edit.range) == BOOK
    assert edit.new_text == rulec.format(BOOK)
    editor.change("laid.rules", edit.new_text, 2)
    assert editor.ask(lsp.TEXT_DOCUMENT_FORMATTING, asked) == []
    editor.change("laid.rules", BOOK.replace("}", ""), 3)
    assert editor.ask(lsp.TEXT_DOCUMENT_FORMATTING, asked) == []


def test_the_outline_names_items_and_examples(editor):
    editor.open("outline.rules", BOOK)
    asked = params(editor, lsp.DocumentSymbolParams, "outline.rules")
    found = editor.ask(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL, asked)
    assert [one.name for one in found] == ["p", "q", "most", "r"]
    assert [shown(BOOK, one.selection_range) for one in found] == ["p", "q", "most", "r"]
    assert found[-1].detail == "hard Art. 1"
    assert [one.name for one in found[-1].children] == ["accept calm"]


def test_rules_and_comments_fold(editor):
    editor.open("folds.rules", BOOK)
    asked = params(editor, lsp.FoldingRangeParams, "folds.rules")
    found = editor.ask(lsp.TEXT_DOCUMENT_FOLDING_RANGE, asked)
    assert {(one.start_line, one.end_line) for one in found} == {(5, 8), (0, 1)}
