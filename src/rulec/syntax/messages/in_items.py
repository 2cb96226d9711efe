"""Help for header lines, declarations, provisions and the parts of rules."""

from __future__ import annotations

from collections.abc import Container
from typing import Final

from rulec.diagnostics import Span
from rulec.diagnostics.ways_out import Help, offering, write
from rulec.syntax.keywords import OPERATOR_LETTERS, OPERATOR_WORDS, RESERVED, UNARY_OPERATORS
from rulec.syntax.messages.in_comparisons import sign_in_words
from rulec.syntax.messages.literals import how_a_date_is_written, meant_date
from rulec.syntax.messages.parse_context import SCOPES, ParseContext

FORMS: Final = {
    "law": 'the line is written `law "…"` or `law "…" as of 2006-03-28`',
    "use": "the line is written `use NAME`",
    "extends": "the line is written `extends NAME`, of one rulebook",
    "traffic": "the line is written `traffic right` or `traffic left`: the side one drives on",
    "semantics": "`stutter` repeats a trace's last state for ever, `finite` (LTLf) ends there",
    "step": "the line is written `step 0.5 s`",
    "priority": "the line is written `priority safety > legal`, the more important one first",
    "vocabulary": "a rulebook declares its words itself, such as `signal NAME`; a vocabulary is a "
    "file of its own",
    "type": "a type is declared by `type NAME` or `type NAME is PARENT`",
    "signal": "a signal is declared by `signal NAME`",
    "quantity": "a quantity is declared by `quantity NAME in UNIT default NUMBER`",
    "constant": "the line is written `constant NAME, NAME`, of names that are declared",
    "presumed": "the line is written `presumed NAME, NAME`, of names that are declared",
    "option": "an option is written `option NAME = on` or `option NAME = off`",
    "param": "a parameter is written `param NAME = 1.5 m`",
    "set": "the line is written `set NAME = on` or `set NAME = 1.5 m`",
    "define": "a definition is written `define NAME(parameters) = formula`",
    "redefine": "a definition is written `redefine NAME(parameters) = formula`",
    "drop": 'the line is written `drop rule NAME because "…"`',
    "soften": 'the line is written `soften rule NAME in LEVEL weight NUMBER because "…"`',
    "topics": 'topics are written `topics { NAME "title" of RULE, RULE; NAME "title" }`',
    "provisions": 'a law is listed as `provisions "link" as of 2024-01-01 { "§ 1" "heading"; … }`',
    "silent": 'the line is written `silent on NAME because "…"`',
}
IN_FORCE: Final = "dates are written `in force from 2020-04-28 until 2024-12-31`"
_DATED: Final = ("param", "set", "in")
_DATED_BY: Final = ("from", "force", "as", "since", "valid", "until")
_EQUALS: Final = ("==", ":=", ":", "is", "to", "->", "=>", "be", "as")
_OTHER_WORDS: Final = {
    **dict.fromkeys(("enum", "enumeration", "state"), "x is one of a, b"),
    **dict.fromkeys(("class", "object", "entity", "struct"), "type NAME"),
    **dict.fromkeys(("number", "float", "real", "int", "integer"), "quantity NAME in UNIT"),
    **dict.fromkeys(("function", "macro", "predicate", "relation"), "define NAME = formula"),
    **dict.fromkeys(("const", "let", "var"), "param NAME = 1.5 m"),
    **dict.fromkeys(("bool", "boolean", "flag"), "signal NAME"),
    **dict.fromkeys(("inherits", "imports"), "extends NAME"),
    **dict.fromkeys(("import", "include", "uses"), "use NAME"),
    **dict.fromkeys(("assume", "axiom", "invariant"), "fact formula"),
}


def other_word(word: str) -> str:
    """Advice on an item keyword of another language; empty if it is unknown."""
    form = _OTHER_WORDS.get(word)
    return f"write `{form}`" if form else ""


def advise_on_item(ctx: ParseContext) -> Help:
    if ctx.kind != "item":
        return ""
    first, text = ctx.first, ctx.text
    dates = advise_on_dates(ctx)
    if dates:
        return dates
    asks = text in UNARY_OPERATORS or text in ("if", "every", "some", "no")
    if asks and ctx.accepted == {"$END"} and ctx.unexpected and ctx.unexpected.first:
        return "what must hold is written in a rule: `hard rule NAME { require … }`"
    is_text = ctx.unexpected is not None and ctx.unexpected.kind == "string"
    if first == "provisions" and "SEMICOLON" in ctx.accepted and is_text:
        return offering("put a `;` between two articles", ctx.separate(";"))
    if first == "use" and text == ",":
        return "write a `use` line for each vocabulary"
    if first == "fact" and text == ":" and ctx.text_at(1) == "(":
        return "leave the variables' types out: a fact is about all objects that fit its words"
    if "ONE" in ctx.accepted:
        return "the values follow `is one of`, such as `is one of a, b`"
    listed = text in (";", "|", "or", "and") or ctx.is_word()
    if "COMMA" in ctx.accepted and listed:
        return offering("separate the names by `,`", ctx.separate(","))
    if ctx.accepted == {"TRUE", "FALSE"}:
        return "a signal is true or false: write `default true` or `default false`"
    if ctx.accepted == {"ON", "OFF"} and text in ("true", "false", "yes", "no"):
        state = "on" if text in ("true", "yes") else "off"
        return offering(f"write `{state}`", state)
    if first in ("option", "set") and text == "in" and ctx.text_before in ("on", "off"):
        return "an option has no dates; a parameter and a rule may have them"
    if first == "priority" and text == "<" and ctx.text_behind:
        order = f"{ctx.text_behind} > {ctx.text_before}"
        return offering(
            f"the more important one comes first: write `{order}`",
            ctx.write(order, ctx.at - 1, ctx.at + 1),
        )
    if ctx.text_at(ctx.at - 2) == "default" and ctx.is_number(ctx.at - 1):
        return f"the number is in the quantity's own unit: `default {ctx.text_before}`"
    if "EQUALS" in ctx.accepted and not ctx.operator and text in _EQUALS:
        return offering(f"write `=` for `{text}`", ctx.write_sign("="))
    if "EQUALS" in ctx.accepted and not ctx.operator and text == "{":
        return f"write `=` before the formula, and no braces: `{first} NAME = formula`"
    if first == "traffic" and ctx.is_word():
        return offering(FORMS[first], "right", "left")
    if "HARD" in ctx.accepted or ctx.operand or ctx.operator or ctx.quantity:
        return ""
    return FORMS.get(first, "")


def advise_on_dates(ctx: ParseContext) -> Help:
    """Help at ``in force from DATE until DATE``."""
    if ctx.accepted == {"DATE"} and ctx.unexpected is not None:
        start = ctx.unexpected.start
        text = ctx.source.text[start : start + 16]
        was, written = meant_date(text)
        day = write(written, Span(ctx.source, start, start + len(was)))
        return offering(how_a_date_is_written(text), *((day,) if written else ()))
    if ctx.first not in _DATED and ctx.kind != "clause":
        return ""
    dated = (
        ("IN" in ctx.accepted and ctx.text in _DATED_BY)
        or "FORCE" in ctx.accepted
        or (ctx.accepted <= {"FROM", "UNTIL", "$END"} and ctx.accepted != {"$END"})
        or (ctx.accepted == {"$END"} and ctx.text == "from")
    )
    return IN_FORCE if dated else ""


_HEAD: Final = "a rule's head is written `hard rule NAME (v: vehicle) in LEVEL weight NUMBER`"
_SCOPE: Final = "a scope is `initially`, `at start`, `throughout`, `at some point`, or `at end`"
_CONFIRMATION: Final = 'a confirmation is written `confirm rule NAME { cite "…" }`'
_REMOVING: Final = ("remove", "delete", "repeal", "abolish", "cancel", "skip", "disable")
_RELATIONS: Final = ("<", "<=", "==", "!=", ">=", ">", ":", ":=")
_EXAMPLE: Final = "an example is written `accept { … }` or `reject { … }`"
_EXCEPT: Final = (
    *("except", "exception", "exempt", "excepting", "excluding"),
    *("exept", "exepct", "excpet", "ecxept", "exeption"),
)
"""Words for an exception, and slips in writing them."""
_OTHER_CLAUSES: Final = {
    **dict.fromkeys(("weight", "in", "level", "priority"), _HEAD),
    **dict.fromkeys(("from", "force", "since", "valid"), IN_FORCE),
    **dict.fromkeys(_EXCEPT, "an exception is written `unless formula`"),
    **dict.fromkeys(("if", "given", "where"), "a condition is written `when formula`"),
    **dict.fromkeys(
        ("must", "shall", "should", "ensure", "assert", "demand", "obliges"),
        "what must hold is written `require formula`",
    ),
    **dict.fromkeys(
        ("forbid", "forbids", "prohibit", "prohibits", "disallow"),
        "what is forbidden is written `require never (formula)`",
    ),
    **dict.fromkeys(
        ("allow", "allows", "allowed", "permit", "permits", "permitted"),
        "an example of what is allowed is written `accept { … }`",
    ),
    **dict.fromkeys(
        ("penalty", "fine", "points", "severity"),
        "how much a rule counts is written in its head: `soft rule NAME weight 3`",
    ),
    **dict.fromkeys(("example", "examples", "test", "tests", "trace", "case"), _EXAMPLE),
    **dict.fromkeys(("description", "text", "comment", "note"), 'write `says "…"`'),
    **dict.fromkeys(("article", "paragraph", "section", "reference"), 'write `cite "…"`'),
    "at": _SCOPE,
    ";": "delete the `;`",
}
_AS_REMEMBERED: Final = ("from", "memory", "remembered", "unsure", "uncertain", "unknown", "none")
_NO_OPERATORS: Final = ("from", "force", "valid", *_EXCEPT, "given", "where", "weight")


def other_clause(word: str, others: Container[str] = ()) -> str:
    """Advice on a clause keyword of another language; empty if it is unknown.

    ``others`` are the words and signs after it.
    """
    if word == "if" and "then" in others:
        return "write `require always (p implies q)` for `if p then q`"
    if "{" in others and "forbidden" in _OTHER_CLAUSES.get(word, ""):
        return "an example of what is forbidden is written `reject { … }`"
    return _OTHER_CLAUSES.get(word, "")


def advise_on_rule_head(ctx: ParseContext) -> Help:
    if ctx.kind != "rule_head":
        return ""
    text = ctx.text
    name = text if ctx.is_word() and text not in RESERVED else "NAME"
    if ctx.at == 0 and text in _REMOVING:
        return f'write `drop rule {ctx.text_at(2) or "NAME"} because "…"`'
    if ctx.at == 0 and ctx.text_at(1).isidentifier() and text == "rule":
        head, soft = f"hard rule {ctx.text_at(1)}", "soft rule"
        return offering(
            f"write `{head}`, or `{soft}` for one that may yield",
            ctx.write(head, 0, 1),
            ctx.write(soft, 0),
        )
    if ctx.at == 0:
        return "a rule begins with `hard rule` or `soft rule`"
    if ctx.text_before == "rule" and ctx.accepted == {"NAME"}:
        return "a rule has a name, which follows `rule`"
    if ctx.first == "confirm" and ctx.at > 1:
        return _CONFIRMATION
    if text == "override" and ctx.accepted == {"RULE"}:
        return f"`override` comes first: `override {ctx.first} rule`"
    if "RULE" in ctx.accepted:
        return f"write `{' '.join(token.text for token in ctx.tokens[: ctx.at])} rule {name}`"
    if (ctx.text_before, text) == ("(", ")"):
        return "a rule without variables has no parentheses"
    if ctx.accepted == {"COLON"}:
        return "a variable is written with its type, such as `v: vehicle`"
    another = ctx.is_word() and (ctx.text == "and" or ctx.text_behind == ":")
    if ctx.accepted >= {"COMMA", "RPAR"} and (another or text == ";"):
        return offering("separate the variables by `,`", ctx.separate(","))
    if ctx.text_before == "weight" and text in ("-", "–", "−"):
        return "a weight is a number above 0"
    if ctx.unexpected is None and ctx.text_before == "(":
        return "a rule's variables go in parentheses; what it says goes between `{` and `}`"
    if ctx.unexpected is None and "RPAR" in ctx.accepted:
        return offering("close the list of variables with `)`", ctx.put_before(")"))
    if text == "," and ctx.text_before != ")" and "RPAR" not in ctx.accepted:
        return "a rule has one name: write a rule for each"
    if text == ":" and "RPAR" not in ctx.accepted:
        return "what a rule says goes between `{` and `}`"
    return _HEAD if "RPAR" not in ctx.accepted else ""


def _begins_scope(ctx: ParseContext) -> bool:
    """Whether a scope may be meant, such as `at start`, and no `at least`."""
    return ctx.text in ("throughout", "at") and not sign_in_words(ctx.text, ctx.text_behind)


_BEHIND_AT: Final = ("start", "end", "some", "least", "most")


def advise_on_clause(ctx: ParseContext) -> Help:
    if ctx.kind == "example_head":
        return _example_head(ctx)
    if ctx.kind != "clause":
        return ""
    behind_text = ctx.before is not None and ctx.before.kind == "string"
    is_text = ctx.first in ("cite", "says", "source")
    if is_text and behind_text and ctx.accepted == {"$END"} and not ctx.is_word():
        return "put all of it between one pair of quotes"
    scoped = ctx.first in ("unless", "also")
    if scoped and ctx.operator and ctx.text == "always":
        return "for the whole time write `throughout`, or nothing"
    if scoped and ctx.text in ("initially", "throughout", "at") and ctx.operand:
        return "the scope follows the formula, such as `unless p throughout`"
    compares = ctx.text == "in" or sign_in_words(ctx.text, ctx.text_behind)
    if scoped and ctx.accepted >= SCOPES and ctx.is_word() and not compares:
        return _SCOPE
    if ctx.operator and ctx.text == "at" and ctx.text_behind not in _BEHIND_AT:
        state = ctx.text_behind if ctx.text_behind.isidentifier() else "q"
        return f"for `p at {state}` write `p and {state}`"
    if ctx.first == "when" and ctx.operator and _begins_scope(ctx):
        return "only an `unless` clause has a scope: a condition has to hold throughout"
    if ctx.first == "require" and ctx.operator and _begins_scope(ctx):
        return "only an `unless` clause has a scope; write `always p` for all of the time"
    if ctx.operator and ctx.text in _NO_OPERATORS:
        return other_clause(ctx.text)
    if ctx.first == "certainty" and ctx.text in _AS_REMEMBERED:
        return "what was written from memory is `unverified`; `source` says in words where from"
    if ctx.first == "certainty":
        return (
            "`verified` was read in the law itself, `secondary` elsewhere, else it is `unverified`"
        )
    return advise_on_dates(ctx) if ctx.first == "in" else ""


def _example_head(ctx: ParseContext) -> Help:
    if ctx.accepted == {"COLON"}:
        return "an object is written with its type, such as `v: vehicle`"
    if ctx.unexpected is not None and ctx.unexpected.kind == "string" and ctx.text_before == ")":
        return f'the label comes before the objects: `{ctx.first} "…" (v: vehicle)`'
    if ctx.is_word() and "STRING" in ctx.accepted:
        return 'put the text in double quotes: "…"'
    return ""


def advise_on_state(ctx: ParseContext) -> Help:
    if ctx.kind != "state":
        return ""
    text = ctx.text
    if ctx.unexpected is None and "NAME" in ctx.accepted:
        return "say what holds in this state; a `;` only separates two states"
    if text == ",":
        return offering(
            "states are separated by `;`, the facts of one state by `and`",
            *map(ctx.write_sign, (";", "and")),
        )
    if text in ("or", "|", "||"):
        return "a state says what holds; for another possibility write another example"
    if text in ("for", "during", "within", "x", "times") or ctx.text_at(ctx.at + 1) == "x":
        return "a state is one step long: write it as often as it lasts, with `;` between"
    if text in OPERATOR_WORDS | OPERATOR_LETTERS:
        return "a state holds atoms and `not` before a signal; no other operator"
    if text == "=" and "not" in (ctx.text_at(ctx.at - 2), ctx.text_at(0)):
        return "a quantity has one value in a state; write `=` without `not`"
    signal = ctx.text_at(ctx.at - 2)
    if ctx.text_before == "=" and text in ("true", "false") and signal.isidentifier():
        return f"write `{signal}` for true and `not {signal}` for false, without `=`"
    if ctx.text_before == "=" and text in ("true", "false"):
        return "what is true is said without `=`, such as `p(v)`, what is not as `not p(v)`"
    if text in ("–", "−", "‑") and ctx.is_number(ctx.at + 1):
        return offering("write `-`", "-")
    number = "NUMBER" in ctx.accepted and "NAME" not in ctx.accepted
    sums = text in ("+", "-", "*", "/")
    if ctx.text_before == "=" and ctx.is_word():
        return (
            f"a quantity gets a number, such as `speed = 50 km/h`; for a value write only `{text}`"
        )
    if number or sums or text in _RELATIONS or ctx.is_number(ctx.at):
        return "a state gives a quantity one value, such as `speed = 50 km/h`"
    return ""
