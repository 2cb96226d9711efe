"""Help for mistakes that people make, by what was probably meant."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from rulec.diagnostics import did_you_mean
from rulec.syntax.keywords import CONTEXTUAL, ITEM_WORDS, RESERVED, UNARY_OPERATORS
from rulec.syntax.messages.in_bounds import advise_on_bound
from rulec.syntax.messages.in_formulas import advise_on_aggregate, advise_on_formula
from rulec.syntax.messages.in_items import FORMS, advise_on_item
from rulec.syntax.messages.in_rules import advise_on_clause, advise_on_rule_head, advise_on_state
from rulec.syntax.messages.parse_context import ParseContext, spelling

_SINGLE: Final = ("'", "“", "”", "„", "‘", "’", "«", "»")


def advise(scene: ParseContext) -> str:
    """The way out, empty when there is none to suggest."""
    return next(filter(None, (advice(scene) for advice in _IN_ORDER)), "")


def _quotes(scene: ParseContext) -> str:
    token, before = scene.unexpected, scene.before
    if token is None:
        return ""
    grouped = scene.is_number(scene.at - 1) and scene.is_number(scene.at + 1)
    if token.kind == "quoted" or (token.text in _SINGLE and not grouped):
        return 'texts stand in straight double quotes: "…"'
    if scene.accepted == {"STRING"} and token.kind != "symbol":
        return 'put the text in double quotes: "…"'
    if token.kind == "string" and "STRING" not in scene.accepted:
        inside = token.text[1:-1]
        if inside in map(spelling, scene.accepted) or ("NAME" in scene.accepted and _names(inside)):
            return f"write `{inside}` without quotes"
    if before is not None and before.kind == "string" and scene.is_word() and scene.touches():
        return 'a quote inside a text is written \\"'
    return ""


def _names(text: str) -> bool:
    return text.isidentifier() and text not in RESERVED


def _comment(scene: ParseContext) -> str:
    return "a comment begins with `#`" if scene.text in ("//", "/*") else ""


def _misspelt(scene: ParseContext) -> str:
    token, before = scene.unexpected, scene.before
    if token is None or token.kind != "word" or token.text.casefold() in RESERVED:
        return ""
    if token.text.casefold() == "infinite":
        return ""  # it is much like `finite` and means the opposite
    words = {word for word in map(spelling, scene.accepted) if word in RESERVED | CONTEXTUAL}
    near = did_you_mean(token.text, words)
    if near or before is None or before.text in RESERVED or not scene.operator:
        return near
    return did_you_mean(before.text, UNARY_OPERATORS)


def _name(scene: ParseContext) -> str:
    token, before = scene.unexpected, scene.before
    if token is None or before is None:
        return ""
    named = "NAME" in scene.accepted and not scene.quantity and token.kind in ("number", "string")
    hyphen = token.text == "-" and scene.touches() and "MINUS" not in scene.accepted
    if scene.kind != "state" and (named or (hyphen and before.kind == "word")):
        return "names are made of letters, digits and `_`, and begin with a letter"
    words = (before.text, token.text) if before.kind == token.kind == "word" else ()
    if scene.accepted == {"$END"} and words and not RESERVED.intersection(words):
        lists = scene.first in ITEM_WORDS and scene.at == 2
        return f"a name is one word, such as `{'_'.join(words)}`" if lists else ""
    return ""


def _punctuation(scene: ParseContext) -> str:
    text = scene.text
    begins = scene.at == 1 and scene.kind == "clause" and text in (":", "=", "-")
    ends = "$END" in scene.accepted or scene.accepted == {"STRING"}
    if begins or (text in (";", ".", ",", ":", "=") and ends):
        return f"delete the `{text}`"
    return ""


def _ending(scene: ParseContext) -> str:
    """The sign with which other languages end a line."""
    last = scene.at == len(scene.tokens) - 1 and scene.text in (";", ".", ",")
    return f"delete the `{scene.text}`" if last and "$END" in scene.accepted else ""


def _parentheses(scene: ParseContext) -> str:
    if scene.text != ")" or scene.operand or scene.quantity or scene.accepted == {"NAME"}:
        return ""
    return "delete the `)`, or open it before" if scene.opened("(", ")") is None else ""


def _form(scene: ParseContext) -> str:
    """The form of the whole line, if no better advice is known."""
    unfinished = scene.unexpected is None and scene.text_before == "="
    formula = not unfinished and (scene.operand or scene.operator or scene.quantity)
    return "" if formula or scene.kind != "item" else FORMS.get(scene.first, "")


_IN_ORDER: tuple[Callable[[ParseContext], str], ...] = (
    _quotes,
    _comment,
    _ending,
    advise_on_bound,
    advise_on_aggregate,
    _misspelt,
    _name,
    advise_on_rule_head,
    advise_on_clause,
    advise_on_item,
    advise_on_state,
    advise_on_formula,
    _punctuation,
    _parentheses,
    _form,
)
