"""Advice on a rule's head, clauses, and states of its examples."""

from __future__ import annotations

from collections.abc import Container
from typing import Final

from rulec.syntax.keywords import OPERATOR_LETTERS, OPERATOR_WORDS, RESERVED
from rulec.syntax.messages.in_items import IN_FORCE, advise_on_dates
from rulec.syntax.messages.parse_context import SCOPES, ParseContext

_HEAD: Final = "a rule's head is written `hard rule NAME (v: vehicle) in LEVEL weight NUMBER`"
_SCOPE: Final = "a scope is `initially`, `at start`, `throughout`, `at some point`, or `at end`"
_REMOVING: Final = ("remove", "delete", "repeal", "abolish", "cancel", "skip", "disable")
_RELATIONS: Final = ("<", "<=", "==", "!=", ">=", ">", ":", ":=")
_EXAMPLE: Final = "an example is written `accept { … }` or `reject { … }`"
_OTHER_CLAUSES: Final = {
    **dict.fromkeys(("weight", "in", "level", "priority"), _HEAD),
    **dict.fromkeys(("from", "force", "since", "valid"), IN_FORCE),
    **dict.fromkeys(("except", "exception", "exempt"), "an exception is written `unless formula`"),
    **dict.fromkeys(("if", "given", "where"), "a condition is written `when formula`"),
    **dict.fromkeys(
        ("must", "shall", "should", "ensure", "assert", "demand", "obliges"),
        "what must hold is written `require formula`",
    ),
    **dict.fromkeys(
        ("forbid", "forbids", "prohibit", "prohibits", "disallow"),
        "what is forbidden is written `require never (formula)`",
    ),
    **dict.fromkeys(("example", "examples", "test", "tests", "trace", "case"), _EXAMPLE),
    **dict.fromkeys(("description", "text", "comment", "note"), 'write `says "…"`'),
    **dict.fromkeys(("article", "paragraph", "section", "reference"), 'write `cite "…"`'),
    "at": _SCOPE,
    ";": "delete the `;`",
}
_NO_OPERATORS: Final = ("from", "force", "valid", "except", "exempt", "given", "where", "weight")


def other_clause(word: str, others: Container[str] = ()) -> str:
    """Advice on another language's clause word; empty if it is unknown.

    ``others`` are the words and signs behind it.
    """
    if word == "if" and "then" in others:
        return "write `require always (p implies q)` for `if p then q`"
    return _OTHER_CLAUSES.get(word, "")


def advise_on_rule_head(scene: ParseContext) -> str:
    if scene.kind != "rule_head":
        return ""
    text = scene.text
    name = text if scene.is_word() and text not in RESERVED else "NAME"
    if scene.at == 0 and text in _REMOVING:
        return f'write `drop rule {scene.text_at(2) or "NAME"} because "…"`'
    if scene.at == 0:
        return "a rule begins with `hard rule` or `soft rule`"
    if scene.text_before == "rule" and scene.accepted == {"NAME"}:
        return "a rule has a name, which stands behind `rule`"
    if text == "override" and scene.accepted == {"RULE"}:
        return f"`override` comes first: `override {scene.first} rule`"
    if "RULE" in scene.accepted:
        return f"write `{' '.join(token.text for token in scene.tokens[: scene.at])} rule {name}`"
    if (scene.text_before, text) == ("(", ")"):
        return "a rule without variables has no parentheses"
    if scene.accepted == {"COLON"}:
        return "a variable is written with its type, such as `v: vehicle`"
    return _HEAD if "RPAR" not in scene.accepted else ""


def advise_on_clause(scene: ParseContext) -> str:
    if scene.kind == "example_head":
        return _example_head(scene)
    if scene.kind != "clause":
        return ""
    scoped = scene.first == "unless"
    if scoped and scene.text in ("initially", "throughout", "at") and scene.operand:
        return "the scope stands behind the formula, such as `unless p throughout`"
    if scoped and scene.accepted >= SCOPES and scene.is_word():
        return _SCOPE
    if scene.first == "require" and scene.operator and scene.text in ("throughout", "at"):
        return "only an `unless` clause has a scope; write `always p` for all of the time"
    if scene.operator and scene.text in _NO_OPERATORS:
        return other_clause(scene.text)
    return advise_on_dates(scene) if scene.first == "in" else ""


def _example_head(scene: ParseContext) -> str:
    if scene.accepted == {"COLON"}:
        return "an object is written with its type, such as `v: vehicle`"
    if (
        scene.unexpected is not None
        and scene.unexpected.kind == "string"
        and scene.text_before == ")"
    ):
        return f'the label stands before the objects: `{scene.first} "…" (v: vehicle)`'
    if scene.is_word() and "STRING" in scene.accepted:
        return 'put the text in double quotes: "…"'
    return ""


def advise_on_state(scene: ParseContext) -> str:
    if scene.kind != "state":
        return ""
    text = scene.text
    if scene.unexpected is None and "NAME" in scene.accepted:
        return "say what holds in this state; a `;` stands only between two states"
    if text == ",":
        return "states are separated by `;`, the facts of one state by `and`"
    if text in ("or", "|", "||"):
        return "a state says what holds; for another possibility write another example"
    if text in OPERATOR_WORDS | OPERATOR_LETTERS:
        return "a state holds atoms and `not` before a signal; no other operator"
    if text == "=" and "not" in (scene.text_at(scene.at - 2), scene.text_at(0)):
        return "a quantity has one value in a state; write `=` without `not`"
    signal = scene.text_at(scene.at - 2)
    if scene.text_before == "=" and text in ("true", "false") and signal.isidentifier():
        return f"write `{signal}` for true and `not {signal}` for false, without `=`"
    number = "NUMBER" in scene.accepted and "NAME" not in scene.accepted
    sums = text in ("+", "-", "*", "/")
    if scene.text_before == "=" and scene.is_word():
        return (
            f"a quantity gets a number, such as `speed = 50 km/h`; a value stands alone: `{text}`"
        )
    if number or sums or text in _RELATIONS or scene.is_number(scene.at):
        return "a state gives a quantity one value, such as `speed = 50 km/h`"
    return ""
