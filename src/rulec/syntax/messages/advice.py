"""Help for mistakes that people make: what stands there, what could, and so what was meant."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from rulec.diagnostics import did_you_mean
from rulec.syntax.keywords import (
    OPERATOR_LETTERS,
    OPERATOR_WORDS,
    PREFIX_LETTERS,
    RESERVED,
    SYMBOLS,
    UNARY_OPERATORS,
)
from rulec.syntax.messages.expectations import wants_operand, wants_operator
from rulec.syntax.scanner import Token


@dataclass(frozen=True, slots=True)
class Scene:
    """A piece that cannot go on: its kind, the token there (None at its end), the one before."""

    kind: str
    first: str
    found: Token | None
    before: Token | None
    accepted: frozenset[str]


_OTHER_SPELLINGS = {
    "implies": ("=>", "==>", "-->", "→", "⇒", "⟹", "⟶"),
    "iff": ("<=>", "===", "↔", "⇔", "⟺", "≡"),
    "and": ("∧", "*", "/"),
    "or": ("∨", "+"),
    "not": ("¬", "~", "-"),
    "always": ("□", "◻", "[", "globally"),
    "eventually": ("◇", "◊", "⋄", "<", "finally"),
    "next": ("○", "◯", "@"),
    "until": ("𝒰",),
    "once": ("◆", "⧫"),
    "historically": ("■", "◼"),
    "previously": ("●",),
    "since": ("𝒮",),
}
_MEANT = {spelling: word for word, group in _OTHER_SPELLINGS.items() for spelling in group}
_FORMS = {
    "law": 'the line is written `law "…"` or `law "…" as of 2006-03-28`',
    "type": "a type is declared by `type NAME` or `type NAME is PARENT`",
    "signal": "a signal is declared by `signal NAME`",
    "quantity": "a quantity is declared by `quantity NAME in UNIT default NUMBER`",
}
_TEMPORAL = OPERATOR_LETTERS | OPERATOR_WORDS - {"not", "and", "or", "implies", "iff", "xor"}


def advise(scene: Scene) -> str:
    """The way out, empty when there is none to suggest."""
    return next(filter(None, (advice(scene) for advice in _IN_ORDER)), "")


def _quotes(scene: Scene) -> str:
    found = scene.found
    if found is None:
        return ""
    if found.kind == "quoted" or found.text in ("'", "“", "”", "„", "‘", "’", "«", "»"):
        return 'texts stand in straight double quotes: "…"'
    if scene.accepted == {"STRING"} and found.kind != "symbol":
        return 'put the text in double quotes: "…"'
    if scene.before is not None and scene.before.kind == "string" and found.kind == "word":
        return 'a quote inside a text is written \\"'
    return ""


def _comment(scene: Scene) -> str:
    return "a comment begins with `#`" if scene.found and scene.found.text in ("//", "/*") else ""


def _misspelt(scene: Scene) -> str:
    """A word that looks much like one that could stand there, or in place of the one before."""
    found, before = scene.found, scene.before
    if found is None or found.kind != "word" or found.text.casefold() in RESERVED:
        return ""
    near = did_you_mean(found.text, {kind.lower() for kind in scene.accepted} & RESERVED)
    if near or before is None or before.text in RESERVED or not wants_operator(scene.accepted):
        return near
    return did_you_mean(before.text, UNARY_OPERATORS)


def _name(scene: Scene) -> str:
    found, before = scene.found, scene.before
    if found is None:
        return ""
    hyphen = found.text == "-" and before is not None and before.end == found.start
    if hyphen or ("NAME" in scene.accepted and found.kind in ("number", "string")):
        return "names are made of letters, digits and `_`, and begin with a letter"
    if scene.accepted == {"$END"} and found.kind == "word" and before and before.kind == "word":
        return f"a name is one word, such as `{before.text}_{found.text}`"
    return ""


def _rule_head(scene: Scene) -> str:
    if scene.kind != "rule_head":
        return ""
    word = scene.found.text if scene.found and scene.found.kind == "word" else ""
    if "HARD" in scene.accepted:
        return "a rule begins with `hard rule` or `soft rule`"
    if scene.accepted == {"NAME"} and scene.before and scene.before.text == "rule":
        return "a rule has a name, which stands behind `rule`"
    if scene.accepted == {"RULE"}:
        return f"write `{scene.first} rule {'NAME' if word in RESERVED or not word else word}`"
    if scene.before is not None and (scene.before.text, scene.found and scene.found.text) == (
        "(",
        ")",
    ):
        return "a rule without variables has no parentheses"
    if scene.accepted == {"COLON"}:
        return "a variable is written with its type, such as `v: vehicle`"
    return ""


def _declaration(scene: Scene) -> str:
    if scene.kind != "item":
        return ""
    if scene.first == "use" and scene.found is not None and scene.found.text == ",":
        return "write a `use` line for each vocabulary"
    if "ONE" in scene.accepted:
        return "the values stand behind `is one of`, such as `is one of a, b`"
    listed = scene.found is not None and (
        scene.found.text in (";", "|", "or", "and") or scene.found.kind == "word"
    )
    if "COMMA" in scene.accepted and listed:
        return "separate the names by `,`"
    if {"TRUE", "FALSE"} == scene.accepted:
        return "a signal is true or false: write `default true` or `default false`"
    return _FORMS.get(scene.first, "")


def _state(scene: Scene) -> str:
    if scene.kind != "state":
        return ""
    text = scene.found.text if scene.found else ""
    if text == ",":
        return "states are separated by `;`, the facts of one state by `and`"
    if text in ("or", "|", "||"):
        return "a state says what holds; for another possibility write another example"
    if text in OPERATOR_WORDS | OPERATOR_LETTERS:
        return "a state holds atoms and `not` before a signal; no other operator"
    if scene.found is None and "NAME" in scene.accepted:
        return "say what holds in this state; a `;` stands only between two states"
    return ""


def _operators(scene: Scene) -> str:
    if scene.found is None:
        return ""
    text = scene.found.text
    before = scene.before.text if scene.before else ""
    operand, operator = wants_operand(scene.accepted), wants_operator(scene.accepted)
    if not (operand or operator or "AND" in scene.accepted):
        return ""
    if operator and len(before) > 1 and set(before) <= set(PREFIX_LETTERS):
        return f"`{before}` is read as one name; write `{' '.join(before)}`"
    if before == "if" or text == "if":
        return "write `p implies q` for `if p then q`"
    if text == "then" and before == "and":
        return "`then` stands alone between two phases: write `p then q`"
    if text in ("=", "=="):
        return "formulas are compared by `iff`; a value is an atom itself, such as `crossing`"
    if text == "[" and before in _TEMPORAL:
        return "bounds of time cannot be written; `next` goes one step ahead, `previously` one back"
    word = _MEANT.get(text) or (text.casefold() if text.casefold() in OPERATOR_WORDS else None)
    fits = operand if word in UNARY_OPERATORS else "AND" in scene.accepted
    if word is not None and text != word and fits:
        symbol = SYMBOLS.get(word, word)
        return f"write `{word}` or `{symbol}`" if symbol != word else f"write `{word}`"
    if before == "weak" or text == "weak":
        return "`weak` stands before `until`, `next` or `previously`"
    if before == "strong" or text == "strong":
        return "`strong` stands before `release`"
    if text in ("<", ">", "<=", ">=", "!="):
        return "formulas are about signals and values; numbers cannot be compared"
    return ""


def _punctuation(scene: Scene) -> str:
    text = scene.found.text if scene.found else ""
    if text in (";", ".", ",", ":", "=") and (
        "$END" in scene.accepted or scene.accepted == {"STRING"}
    ):
        return f"delete the `{text}`"
    return ""


_IN_ORDER: tuple[Callable[[Scene], str], ...] = (
    _quotes,
    _comment,
    _misspelt,
    _name,
    _rule_head,
    _declaration,
    _state,
    _operators,
    _punctuation,
)
