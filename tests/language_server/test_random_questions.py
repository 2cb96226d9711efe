"""Whatever stands in a document, every question about it has an answer, or none."""

from contextlib import suppress
from random import Random

from lsprotocol import types as lsp

from rulec.language_server.document_outline import folds, outline
from rulec.language_server.lenses.code_lenses import KnownAnswers, code_lenses
from rulec.language_server.lenses.inlay_hints import inlay_hints
from rulec.language_server.names.hover_texts import hover_text
from rulec.language_server.names.name_occurrences import names_in_document
from rulec.language_server.names.renaming import (
    RefusedRenamingError,
    declaration_of,
    references_to,
    to_rename,
)
from rulec.language_server.workspace.editor_workspace import EditorWorkspace
from rulec.language_server.writing.quick_fixes import code_action, quick_fixes
from rulec.language_server.writing.word_completion import completions, signature
from support.generators.random_edits import edited

BOOK = """\
rulebook asked
extends upper
set near = 4 m
define close(o: vehicle) = gap(o) < near

override rule first {
  also unless close(o) and fog at some point
}
soft rule second(o: vehicle) in comfort weight 2 {
  says "𝔽𝕠𝕘"
  require never (close(o) and speed > 3 km/h) and some x: vehicle (gap_x > 0)
  accept "calm" { gap_o = 20 m }
}
topics { ways "Ways" of second }
"""
UPPER = """\
rulebook upper
use road
priority law > comfort
param near : length = 5 m
signal fog default false
hard rule first(o: vehicle) in law {
  cite "Art. 1"
  require always (gap(o) > near or speed = 0 km/h)
}
"""


def ask_everything(editor, document, offset):
    checked = editor.check(document)
    positions = editor.positions(document.text)
    whole = positions.whole()
    for fix in quick_fixes(checked, document, lsp.Range(whole.start, whole.start), editor):
        code_action(fix, document.uri, document.text, editor)
    names = names_in_document(checked)
    if names is None:
        return 0
    outline(names, positions)
    folds(names, positions)
    inlay_hints(names, positions, whole)
    code_lenses(names, positions, document.uri, KnownAnswers())
    signature(names, offset)
    found = len(completions(names, offset, positions, editor))
    for one in names.all():
        assert document.text[one.span.start : one.span.end] == one.span.text
        hover_text(names, one)
        declaration_of(names, one.symbol, editor)
    one = names.at(offset)
    if one is not None:
        references_to(one.symbol, names, editor)
        with suppress(RefusedRenamingError):
            to_rename(names, offset, editor)
    return found


def test_every_answer_after_random_edits(tmp_path):
    random, text = Random(5), BOOK
    editor = EditorWorkspace((tmp_path,))
    editor.open((tmp_path / "upper.rules").as_uri(), UPPER)
    offered = 0
    for _ in range(12):
        document = editor.open((tmp_path / "asked.rules").as_uri(), text)
        offered += ask_everything(editor, document, random.randrange(len(text) + 1))
        text = edited(text, BOOK, random) or BOOK
    assert offered
