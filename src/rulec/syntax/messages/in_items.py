"""Help for header lines, declarations, and what a rulebook provides."""

from __future__ import annotations

from typing import Final

from rulec.syntax.messages.parse_context import ParseContext

FORMS: Final = {
    "law": 'the line is written `law "…"` or `law "…" as of 2006-03-28`',
    "use": "the line is written `use NAME`",
    "extends": "the line is written `extends NAME`, of one rulebook",
    "traffic": "the line is written `traffic right` or `traffic left`: the side one drives on",
    "semantics": "`stutter` repeats a trace's last state for ever, `finite` (LTLf) ends there",
    "step": "the line is written `step 0.5 s`",
    "priority": "the line is written `priority safety > legal`, the more important one first",
    "type": "a type is declared by `type NAME` or `type NAME is PARENT`",
    "signal": "a signal is declared by `signal NAME`",
    "quantity": "a quantity is declared by `quantity NAME in UNIT default NUMBER`",
    "option": "an option is written `option NAME = on` or `option NAME = off`",
    "param": "a parameter is written `param NAME = 1.5 m`",
    "set": "the line is written `set NAME = on` or `set NAME = 1.5 m`",
    "define": "a definition is written `define NAME(parameters) = formula`",
    "redefine": "a definition is written `redefine NAME(parameters) = formula`",
    "drop": 'the line is written `drop rule NAME because "…"`',
    "soften": 'the line is written `soften rule NAME in LEVEL weight NUMBER because "…"`',
    "silent": 'the line is written `silent on NAME because "…"`',
}
IN_FORCE: Final = "dates are written `in force from 2020-04-28 until 2024-12-31`"
_DATED: Final = ("param", "set", "in")
_EQUALS: Final = ("==", ":=", ":", "is", "to", "->", "=>", "be", "as")
_OTHER_WORDS: Final = {
    **dict.fromkeys(("enum", "enumeration", "state"), "x is one of a, b"),
    **dict.fromkeys(("class", "object", "entity", "struct"), "type NAME"),
    **dict.fromkeys(("number", "float", "real", "int", "integer"), "quantity NAME in UNIT"),
    **dict.fromkeys(("function", "macro", "predicate", "relation"), "define NAME = formula"),
    **dict.fromkeys(("const", "constant", "let", "var"), "param NAME = 1.5 m"),
    **dict.fromkeys(("bool", "boolean", "flag"), "signal NAME"),
    **dict.fromkeys(("inherits", "imports"), "extends NAME"),
    **dict.fromkeys(("assume", "axiom", "invariant"), "fact formula"),
}


def other_word(word: str) -> str:
    """Advice on another language's item word; empty if it is unknown."""
    form = _OTHER_WORDS.get(word)
    return f"write `{form}`" if form else ""


def advise_on_item(scene: ParseContext) -> str:
    if scene.kind != "item":
        return ""
    first, text = scene.first, scene.text
    dates = advise_on_dates(scene)
    if dates:
        return dates
    if first == "use" and text == ",":
        return "write a `use` line for each vocabulary"
    if first == "fact" and text == ":" and scene.text_at(1) == "(":
        return "leave the variables' types out: a fact is about all objects that fit its words"
    if "ONE" in scene.accepted:
        return "the values stand behind `is one of`, such as `is one of a, b`"
    listed = text in (";", "|", "or", "and") or scene.is_word()
    if "COMMA" in scene.accepted and listed:
        return "separate the names by `,`"
    if scene.accepted == {"TRUE", "FALSE"}:
        return "a signal is true or false: write `default true` or `default false`"
    if scene.accepted == {"ON", "OFF"} and text in ("true", "false", "yes", "no"):
        return f"write `{'on' if text in ('true', 'yes') else 'off'}`"
    if first in ("option", "set") and text == "in" and scene.text_before in ("on", "off"):
        return "an option has no dates; a parameter and a rule may have them"
    if first == "priority" and text == "<" and scene.text_behind:
        return (
            "the more important one stands first: "
            f"write `{scene.text_behind} > {scene.text_before}`"
        )
    if scene.text_at(scene.at - 2) == "default" and scene.is_number(scene.at - 1):
        return f"the number is in the quantity's own unit: `default {scene.text_before}`"
    if "EQUALS" in scene.accepted and not scene.operator and text in _EQUALS:
        return f"write `=` for `{text}`"
    if "EQUALS" in scene.accepted and not scene.operator and text == "{":
        return f"write `=` before the formula, and no braces: `{first} NAME = formula`"
    if "HARD" in scene.accepted or scene.operand or scene.operator or scene.quantity:
        return ""
    return FORMS.get(first, "")


def advise_on_dates(scene: ParseContext) -> str:
    """At ``in force from DATE until DATE``."""
    if scene.accepted == {"DATE"} and scene.unexpected is not None:
        return "a date is written year-month-day, such as `2006-03-28`"
    if scene.first not in _DATED and scene.kind != "clause":
        return ""
    if scene.text in ("from", "force") and "IN" in scene.accepted:
        return IN_FORCE
    if scene.text in ("as", "since", "valid", "until") and "IN" in scene.accepted:
        return IN_FORCE
    if "FORCE" in scene.accepted or (
        scene.accepted <= {"FROM", "UNTIL", "$END"} and scene.accepted != {"$END"}
    ):
        return IN_FORCE
    if scene.accepted == {"$END"} and scene.text == "from":
        return IN_FORCE
    return ""
