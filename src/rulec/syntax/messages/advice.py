"""Help for common mistakes, by what was probably meant."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import Final

from rulec.diagnostics import nearest_name
from rulec.diagnostics.ways_out import Help, meant, offering
from rulec.syntax.keywords import (
    CLAUSE_WORDS,
    CONTEXTUAL,
    ITEM_WORDS,
    OPERATOR_LETTERS,
    OPERATOR_WORDS,
    PREFIX_LETTERS,
    RESERVED,
    UNARY_OPERATORS,
)
from rulec.syntax.messages.decimal_points import advise_on_point
from rulec.syntax.messages.in_comparisons import RELATIONS, sign_in_words
from rulec.syntax.messages.in_formulas import (
    AGGREGATES,
    IN_DIGITS,
    PAST,
    advise_on_aggregate,
    advise_on_formula,
    advise_on_parentheses,
)
from rulec.syntax.messages.in_items import (
    FORMS,
    advise_on_clause,
    advise_on_item,
    advise_on_rule_head,
    advise_on_state,
)
from rulec.syntax.messages.in_sentences import advise_on_pair, of_owner
from rulec.syntax.messages.other_scripts import advise_on_script
from rulec.syntax.messages.parse_context import (
    COMMENT,
    DELETE_IT,
    ParseContext,
    is_comment,
    is_invisible,
    spelling,
)

_BOOLEAN: Final = frozenset(
    (*("not", "and", "or", "implies", "iff", "xor"), *("!", "&", "&&", "|", "||", "->", "<->", "^"))
)
OVER_TIME: Final = (OPERATOR_WORDS | OPERATOR_LETTERS | {"[]", "<>"}) - _BOOLEAN
_OF_TIME: Final = ("ms", "s", "min", "h", "step", "steps")
_DASHES: Final = ("-", "–", "—", "−", "…", "...")
_BETWEEN: Final = ("to", *_DASHES, ",", ";", ":", "and", "until")
_OPENINGS: Final = ("<=", ">=", "<", ">", "=", "{", "in", "within")
_FORMS: Final = "a bound is written `[<= 3 s]`, `[>= 1 s]`, `[1 s .. 4 s]` or `[2 steps]`"
_FORMULA_IN_BRACKETS: Final = "a formula goes in parentheses, `(p or q)`; brackets hold time bounds"
_NUMBER: Final = re.compile(r"\d+(?:\.\d+)?")
_RANGE: Final = re.compile(r"(\d+)[-–](\d+)")
_WITHIN: Final = ("within", "for", "during", "after")


def advise_on_bound(ctx: ParseContext) -> Help:
    """Help inside brackets, and where a bound was probably meant."""
    if ctx.opened("[", "]") is not None and not ctx.operand:
        return _inside(ctx)
    text, before = ctx.text, ctx.text_before
    if text == "[" and ctx.operand and _holds_a_formula(ctx):
        return _FORMULA_IN_BRACKETS
    if text == "[" and ctx.operand and before in _BOOLEAN:
        return "only operators over time take a bound, such as `always[<= 3 s]`"
    if text == "[" and ctx.operator and (near := _word_before(ctx, UNARY_OPERATORS)):
        return near
    if text == "[" and (ctx.operand or ctx.operator):
        return "a bound follows its operator, such as `always[<= 3 s] p`"
    called = ctx.text_at(ctx.at - 2) if before == "(" else before
    opens = text in _OPENINGS and (called == before or ctx.is_number(ctx.at + 1))
    if ctx.operand and called in OVER_TIME and opens and not _holds_a_formula(ctx):
        return f"a bound goes in brackets, such as `{called}[<= 3 s]`"
    if ctx.operand and before == "]" and text in _BETWEEN and ctx.is_number(ctx.at + 1):
        return "a bound's two ends go in one pair of brackets, such as `[3 s .. 4 s]`"
    for word, at in ((text, ctx.at + 1), (before, ctx.at)):
        if word in _WITHIN and ctx.operator:
            return _of_time(ctx, word, at)
    return ""


def _of_time(ctx: ParseContext, word: str, at: int) -> Help:
    """Help at ``within 3 s`` and ``within the last 3 s``; empty without a number."""
    at += ctx.text_at(at) == "the"
    past = ctx.text_at(at) in PAST
    at += past or ctx.text_at(at) == "next"
    if not ctx.is_number(at):
        return ""
    amount = ctx.source.text[ctx.tokens[at].start : _end_of_amount(ctx, at)]
    if word == "after":
        return f"write `next[{amount}] p`"
    lasts = word != "within"
    before, ahead = ("historically", "always") if lasts else ("once", "eventually")
    if past:
        return f"write `{before}[<= {amount}] p`"
    return f"write `{ahead}[<= {amount}] p`, or `{before}[<= {amount}] p` of the past"


def _holds_a_formula(ctx: ParseContext) -> bool:
    """Whether the content of a bracket does not begin with a time."""
    behind = ctx.token(ctx.at + 1)
    return behind is not None and (behind.kind == "word" or behind.text in ("!", "("))


def _inside(ctx: ParseContext) -> Help:
    text, before = ctx.text, ctx.text_before
    opened = ctx.opened("[", "]")
    only_word = opened == ctx.at - 2 and before.isidentifier()
    if only_word and before in (*_WITHIN, "max") and ctx.is_number(ctx.at):
        amount = ctx.source.text[ctx.tokens[ctx.at].start : _end_of_amount(ctx, ctx.at)]
        return f"for `{before} {amount}` write `[<= {amount}]`"
    is_time = ctx.is_number(ctx.at + 1) and ctx.text_at(ctx.at + 2) in _OF_TIME
    if only_word and not is_time and (text in RELATIONS or text in OPERATOR_WORDS):
        return _FORMULA_IN_BRACKETS
    if match := _RANGE.fullmatch(text):
        return _both_ends(match[1], match[2], ctx.text_behind)
    if ctx.accepted == {"UNIT"}:
        if text == ".." or (text in _DASHES and ctx.is_number(ctx.at + 1)):
            return _both_ends(before, ctx.text_behind, ctx.text_at(ctx.at + 2))
        return f"say what it counts: `{before} s` or `{before} steps`"
    if (sign := sign_in_words(before, text)) and ctx.is_number(ctx.at + 1):
        amount = ctx.source.text[ctx.tokens[ctx.at + 1].start : _end_of_amount(ctx, ctx.at + 1)]
        return f"for `{before} {text}` write `[{sign} {amount}]`"
    if before.casefold() in IN_DIGITS and ctx.is_word():
        return f"write the number in digits: `{IN_DIGITS[before.casefold()]} {text}`"
    if text in ("<=", ">=") and ctx.is_number(ctx.at - 2):
        return f"the sign comes before the time: `[{text} {ctx.text_at(ctx.at - 2)} {before}]`"
    if before == "[" and text in ("<", "=<", ">", "=>"):
        sign = "<=" if "<" in text else ">="
        return f"a bound includes its end: write `[{sign} 3 s]`"
    if before == "[" and text in ("=", "=="):
        return "for exactly that time write `[3 s]`"
    if before == "[" and text == "..":
        return "without a lower end write `[<= 3 s]`"
    if before == ".." and text == "]":
        return "without an upper end write `[>= 3 s]`"
    if text == "-" and "NUMBER" in ctx.accepted:
        return "a bound counts forward, or back for `once` and its family: it has no sign"
    if "TO" in ctx.accepted and text in _BETWEEN:
        return offering("write `..` between the two ends, such as `[3 s .. 4 s]`", "..")
    if ctx.accepted <= {"RSQB", "TO", "LPAR"} and text not in (*RELATIONS, *"+*/-", ".."):
        return offering("close the bound with `]`", ctx.put_before("]"))
    return _FORMS


def _both_ends(low: str, high: str, unit: str) -> str:
    """How a time interval is written, with its ends as far as they are known."""
    if not (_NUMBER.fullmatch(low) and _NUMBER.fullmatch(high) and unit.isalpha()):
        low, high, unit = "3", "4", "s"
    return f"write the unit at both ends, and `..` between: `[{low} {unit} .. {high} {unit}]`"


def _end_of_amount(ctx: ParseContext, at: int) -> int:
    unit = ctx.token(at + 1)
    return unit.end if unit and unit.kind == "word" and at + 2 > ctx.at else ctx.tokens[at].end


_SINGLE: Final = ("'", "“", "”", "„", "‘", "’", "«", "»")


def advise(ctx: ParseContext) -> Help:
    """The suggested correction; empty if there is none."""
    for advice in _IN_ORDER:
        if way_out := advice(ctx):
            return way_out
    return ""


def _quotes(ctx: ParseContext) -> Help:
    token, before = ctx.unexpected, ctx.before
    if token is None:
        return ""
    grouped = ctx.is_number(ctx.at - 1) and ctx.is_number(ctx.at + 1)
    if token.text[0] in "'’" and before is not None and before.kind == "word" and ctx.touches():
        owned = ctx.text_at(ctx.at + 2)
        if ctx.operator and ctx.text_behind == "s" and _names(owned):
            return of_owner(before.text, owned)
        later = "; what is so in the next state is written `next p`" if ctx.operator else ""
        return f"a name has letters, digits and `_` only{later}"
    if token.kind == "string" and ctx.first == "fact" and ctx.at == 1:
        return "a fact has no label: write it above, as a remark that begins with `#`"
    if token.kind == "quoted" or (token.text in _SINGLE and not grouped):
        name = token.text.strip("'") if token.kind == "quoted" else ctx.text_behind
        if ctx.operand and name.isidentifier():
            last = ctx.at if token.kind == "quoted" else ctx.at + 2
            closed = last == ctx.at or ctx.text_at(last) in _SINGLE
            plain = (ctx.write(name, ctx.at, last),) if closed else ()
            return offering(f"write `{name}` without quotes", *plain)
        return 'texts go in straight double quotes: "…"'
    if ctx.accepted == {"STRING"} and (token.kind != "symbol" or token.text == "§"):
        return 'put the text in double quotes: "…"'
    if token.kind == "string" and "STRING" not in ctx.accepted:
        inside = token.text[1:-1]
        if ctx.quantity and _QUANTITY.fullmatch(inside):
            return offering(f"write `{inside}` without quotes", inside)
        if inside in map(spelling, ctx.accepted) or ("NAME" in ctx.accepted and _names(inside)):
            return offering(f"write `{inside}` without quotes", inside)
    if before is not None and before.kind == "string" and ctx.is_word() and ctx.touches():
        return 'a quote inside a text is written \\"'
    return ""


_QUANTITY: Final = re.compile(r"[0-9.]+ ?[A-Za-z%/0-9]*")


def _names(text: str) -> bool:
    return text.isidentifier() and text not in RESERVED


def _comment(ctx: ParseContext) -> Help:
    minus = ctx.operator and ctx.text == "–"
    if "$END" in ctx.accepted and is_comment(ctx.tokens, ctx.at) and not minus:
        return COMMENT
    if ctx.text == "§":
        return 'an article is cited in its rule, such as `cite "§ 3"`; a remark begins with `#`'
    return COMMENT if ctx.text in ("//", "/*") else ""


def _name_of_two_words(ctx: ParseContext) -> Help:
    is_name = ctx.kind == "rule_head" and ctx.text_at(ctx.at - 2) == "rule"
    if is_name and ctx.is_word() and ctx.text not in ITEM_WORDS | CLAUSE_WORDS:
        words = [ctx.text_before]
        for token in ctx.tokens[ctx.at :]:
            if token.kind != "word" or token.text in ("in", "weight"):
                break
            words.append(token.text)
        return f"a name is one word: `{'_'.join(words)}`"
    assigned = ctx.at == 2 and ctx.first in ("set", "param", "option", "define", "redefine")
    if assigned and ctx.is_word() and ctx.text_at(ctx.at + 1) in ("=", ":"):
        return f"a name is one word: `{ctx.text_before}_{ctx.text}`"
    return ""


def _misspelt_prefix(ctx: ParseContext) -> Help:
    """Help at an operand after a name that resembles a prefix: `alway not p`, `evry x: vehicle`."""
    token, before = ctx.unexpected, ctx.before
    if token is None or not ctx.operator:
        return ""
    if ctx.text_behind in _AFTER_STRENGTH and token.text not in RESERVED:
        return meant(token.text, ("weak", "strong"), _MUCH_ALIKE)
    if before is None or before.kind != "word" or before.text in RESERVED:
        return ""
    words: tuple[str, ...] = ()
    if ctx.text_behind == ":":
        words = AGGREGATES
    elif token.kind == "number" or token.text in _OPERAND_WORDS:
        words = (*UNARY_OPERATORS, *(("weak",) if token.text in _AFTER_STRENGTH else ()))
    return _word_before(ctx, words, _MUCH_ALIKE)


def _word_before(ctx: ParseContext, known: Iterable[str], alike: float = 0.6) -> Help:
    """Help with the word before the unexpected token, if it resembles a known one."""
    near = nearest_name(ctx.text_before, known, alike)
    at = ctx.at - 1
    return "" if near is None else offering(f"did you mean `{near}`?", ctx.write(near, at))


_MUCH_ALIKE: Final = 0.75
"""The least similarity; with less, a name such as `now` would count as `not`."""
_AFTER_STRENGTH: Final = ("next", "previously", "until", "release")
_OPERAND_WORDS: Final = frozenset(
    (*UNARY_OPERATORS, *AGGREGATES, *PREFIX_LETTERS, "!", "weak", "true", "false")
)


def _misspelt(ctx: ParseContext) -> Help:
    token, before = ctx.unexpected, ctx.before
    if token is None or token.kind != "word" or token.text.casefold() in RESERVED:
        return ""
    if token.text.casefold() in ("infinite", "twice"):
        return ""  # they are much like `finite` and `since`, and mean something else
    if before and ctx.operator and (sign := sign_in_words(before.text, token.text)):
        # Without a sign before it, it is about how many.
        is_twice = ctx.text_at(ctx.at - 2) in RELATIONS
        return f"for `{before.text} {token.text}` write `{sign}`" if is_twice else ""
    words = {word for word in map(spelling, ctx.accepted) if word in RESERVED | CONTEXTUAL}
    # One letter is a name, such as `f` behind `eventualy`, and no word misspelt.
    near = meant(token.text, words) if len(token.text) > 1 else ""
    if near or before is None or before.text in RESERVED or not ctx.operator:
        return near
    if before.text in _EARLIER:
        return "numbers of earlier states cannot be read; formulas can: `previously (speed > 0)`"
    if number := IN_DIGITS.get(before.text.casefold()):
        return f"write the number in digits: `{number}` for `{before.text}`"
    return _word_before(ctx, UNARY_OPERATORS)


_EARLIER: Final = ("previous", "last", "prior", "earlier", "old")


def _least(ctx: ParseContext) -> Help:
    opened = ctx.opened("(", ")")
    function = "" if opened is None else ctx.text_at(opened - 1)
    if function not in ("min", "max") or ctx.operand:
        return ""
    word = "and" if function == "min" else "or"
    return f"there is no `{function}`: compare one after the other, `x <= a {word} x <= b`"


def _name(ctx: ParseContext) -> Help:
    token, before = ctx.unexpected, ctx.before
    if token is None or before is None:
        return ""
    named = "NAME" in ctx.accepted and not ctx.quantity and token.kind in ("number", "string")
    hyphen = token.text == "-" and ctx.touches() and "MINUS" not in ctx.accepted
    if ctx.kind != "state" and (named or (hyphen and before.kind == "word")):
        rule = "names are made of letters, digits and `_`, and begin with a letter"
        name = re.sub(r"\W+", "_", token.text.casefold()).strip("_")
        if hyphen:
            name = f"{before.text}_{ctx.text_behind}" if ctx.text_behind else ""
        is_text = (token.kind == "string" or hyphen) and name.isidentifier()
        if is_text and name not in RESERVED:
            return f"{rule}, such as `{name}`"
        return f"{rule}; its article is said by `cite`" if before.text == "rule" else rule
    words = (before.text, token.text) if before.kind == token.kind == "word" else ()
    if ctx.accepted == {"$END"} and words and not RESERVED.intersection(words):
        lists = ctx.first in ITEM_WORDS and ctx.at == 2
        return f"a name is one word, such as `{'_'.join(words)}`" if lists else ""
    return ""


def _punctuation(ctx: ParseContext) -> Help:
    text = ctx.text
    begins = ctx.at == 1 and ctx.kind in ("clause", "item") and text in (":", "=", "-")
    ends = "$END" in ctx.accepted or ctx.accepted == {"STRING"}
    if begins or (text in (";", ".", ",", ":", "=") and ends):
        return offering(f"delete the `{text}`", ctx.leave_out(ctx.at))
    return ""


def _ending(ctx: ParseContext) -> Help:
    last = ctx.at == len(ctx.tokens) - 1 and ctx.text in (";", ".", ",")
    is_end = last and "$END" in ctx.accepted
    return offering(f"delete the `{ctx.text}`", ctx.leave_out(ctx.at)) if is_end else ""


def _form(ctx: ParseContext) -> Help:
    """The form of the whole line, if there is no better advice."""
    unfinished = ctx.unexpected is None and ctx.text_before == "="
    formula = not unfinished and (ctx.operand or ctx.operator or ctx.quantity)
    return "" if formula or ctx.kind != "item" else FORMS.get(ctx.first, "")


def _invisible(ctx: ParseContext) -> Help:
    return offering(DELETE_IT, ctx.leave_out(ctx.at)) if is_invisible(ctx.text) else ""


_IN_ORDER: tuple[Callable[[ParseContext], Help], ...] = (
    _invisible,
    advise_on_script,
    advise_on_point,
    _quotes,
    _comment,
    _ending,
    advise_on_bound,
    advise_on_pair,
    _misspelt_prefix,
    advise_on_aggregate,
    _name_of_two_words,
    _misspelt,
    _least,
    _name,
    advise_on_rule_head,
    advise_on_clause,
    advise_on_item,
    advise_on_state,
    advise_on_formula,
    _punctuation,
    advise_on_parentheses,
    _form,
)
