"""Help inside formulas: quantifiers, arguments, conditionals and operators."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from rulec.diagnostics import Span
from rulec.diagnostics.ways_out import Help, meant, offering, write
from rulec.syntax import keywords
from rulec.syntax.messages.in_comparisons import (
    ABSOLUTE,
    NO_ABSOLUTE_VALUE,
    RELATIONS,
    advise_on_comparison,
    advise_on_number,
)
from rulec.syntax.messages.in_sentences import advise_on_sentence, of_owner
from rulec.syntax.messages.parse_context import ParseContext
from rulec.syntax.scanner import Token

_OTHER_SPELLINGS: Final = {
    "implies": ("=>", "==>", "-->", "→", "⇒", "⟹", "⟶"),
    "iff": ("<=>", "===", "↔", "⇔", "⟺", "≡"),
    "and": ("∧", "und", "og", "och", "en", "et", "oraz"),
    "or": ("∨", "oder", "eller", "of", "ou", "lub"),
    "not": ("¬", "~", "nicht", "ikke", "inte", "niet", "nie", "pas", "non"),
    "always": ("□", "◻", "globally"),
    "eventually": ("◇", "◊", "⋄", "finally"),
    "next": ("○", "◯", "@"),
    "until": ("𝒰",),
    "once": ("◆", "⧫"),
    "historically": ("■", "◼"),
    "previously": ("●",),
    "since": ("𝒮",),
}
_MEANT: Final = {spelling: word for word, group in _OTHER_SPELLINGS.items() for spelling in group}
_QUANTIFIERS: Final = {
    **dict.fromkeys(("exists", "any", "∃", "there"), "some"),
    **dict.fromkeys(("forall", "all", "each", "∀", "for"), "every"),
    **dict.fromkeys(("number", "sum", "#"), "count"),
}
IN_DIGITS: Final = {
    name: number
    for number, name in enumerate(
        ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"), start=1
    )
}
PAST: Final = ("last", "past", "previous")
AGGREGATES: Final = ("some", "every", "count")
_ARGUMENT: Final = "an argument is a name; it has no arguments of its own"


def advise_on_formula(ctx: ParseContext) -> Help:
    """Advice on a mistake in a formula; empty if there is none."""
    if not (ctx.operand or ctx.operator or ctx.quantity or "AND" in ctx.accepted):
        return _arguments(ctx)
    of_values = advise_on_number, advise_on_comparison
    for advise in (_conditionals, advise_on_sentence, *of_values, _operators, _joined):
        way_out = advise(ctx)
        if way_out:
            return way_out
    return ""


def advise_on_aggregate(ctx: ParseContext) -> Help:
    """Help at ``some``, ``every``, ``count``, and their equivalents in other languages."""
    text, before = ctx.text, ctx.text_before
    if ctx.operator and before == "at" and ctx.text_behind in ("time", "times"):
        return offering(
            f"for `at {text} {ctx.text_behind}` write `always`",
            ctx.write("always", ctx.at - 1, ctx.at + 1),
        )
    if ctx.operator and before == "no" and ctx.is_word():
        named = ctx.text_behind if ctx.text_behind.isidentifier() else ""
        plain = "" if named else f"`not {text}`, of objects "
        # `no vehicle v`, or `no vehicle beside`
        head = f"{named}: {text} (…)"
        if len(named) != 1:
            head = f"x: {text} ({f'{named}(x)' if named else '…'})"
        denied = () if named else (ctx.write(f"not {text}", ctx.at - 1, ctx.at),)
        return offering(f"for `no {text}` write {plain}`not some {head}`", *denied)
    if text == "every" and ctx.operator and ctx.is_number(ctx.at + 1):
        return "for `p every 4 h` write `always eventually[<= 4 h] p`"
    word = _QUANTIFIERS.get(text) or (_QUANTIFIERS.get(before) if ctx.operator else None)
    if word and (ctx.operand or ctx.operator) and ctx.unexpected is not None:
        if any(ctx.is_number(ctx.at + number) for number in range(1, 4)) and text == "for":
            past = ctx.text_at(ctx.at + 2) in PAST
            word = "historically" if past else "always"
            return f"for how long is written as a bound, such as `{word}[<= 3 s] p`"
        if word == "every" and ctx.first == "require" and ctx.at <= 2:
            # Around a whole requirement `every` would forbid its operators over time.
            return (
                "a rule holds for every one: leave this out, and write `(v: vehicle)` after "
                "the rule's name"
            )
        at = ctx.at + (text in _QUANTIFIERS)
        own = ctx.text_at(at + 1) == ":" and ctx.text_at(at + 2).isidentifier()
        variable = f"{ctx.text_at(at)}: {ctx.text_at(at + 2)}" if own else "x: vehicle"
        return f"write `{word} {variable} (…)`"
    if before in AGGREGATES and ctx.accepted == {"NAME"}:
        return f"it is written `{before} x: vehicle (…)`"
    is_head = ctx.text_at(ctx.at - 2) == "(" and ctx.text_at(ctx.at - 3) != "fact"
    if text == ":" and ctx.operator and is_head:
        head = f"{before}: {ctx.text_at(ctx.at + 1)}"
        return f"write `every {head} (…)` or `some {head} (…)`, or declare it after the rule's name"
    if text in keywords.UNARY_OPERATORS and ctx.operator and ctx.first not in ("unless", "also"):
        if ctx.text_behind in ("", "}"):
            return f"it comes before what it is about: `{text} p`"
        return f"it comes before what it is about, such as `{text} (speed > 50 km/h)`"
    heads = [index for index in range(ctx.at) if ctx.text_at(index) in AGGREGATES]
    if not heads or ctx.at - heads[-1] > 4:
        return ""
    word = ctx.text_at(heads[-1])
    if text == "," and ctx.accepted <= {"COLON", "LPAR"}:
        return f"it has one variable; put one inside the other: `{word} x: T ({word} y: T (…))`"
    if ctx.accepted == {"LPAR"}:
        return f"what is said about it goes in parentheses: `{word} x: vehicle (…)`"
    if ctx.accepted == {"COLON"}:
        return f"it is written `{word} x: vehicle (…)`"
    return ""


def no_operator(ctx: ParseContext) -> tuple[int, Help] | None:
    """The index of a word that is meant for an operator and is none, and what may help.

    ``nevr (p and q)`` and ``nie (p(x) …)`` read as a name with arguments up to a word behind.
    """
    opened = ctx.opened("(", ")")
    in_formula = ctx.kind in ("clause", "formula", "item")
    if not opened or not in_formula or ctx.accepted != {"COMMA", "RPAR"} or ctx.text in (")", ":"):
        return None
    if near := meant(ctx.text_at(opened - 1), keywords.UNARY_OPERATORS):
        return opened - 1, near
    is_spaced = ctx.tokens[opened - 1].end < ctx.tokens[opened].start
    if ctx.text != "(" or not is_spaced or ctx.text_at(opened - 1).casefold() in ABSOLUTE:
        return None
    return opened - 1, f"if it is meant for a name, {_ARGUMENT}"


def _arguments(ctx: ParseContext) -> Help:
    opened = ctx.opened("(", ")")
    if opened is None or ctx.kind not in ("clause", "formula", "item"):
        return ""
    if ctx.accepted == {"NAME"} and ctx.text_before == "(" and ctx.text == ")":
        return "without arguments there are no parentheses"
    if ctx.accepted == {"NAME"} and ctx.text_before == "," and ctx.text == ")":
        return offering("delete the `,`", ctx.leave_out(ctx.at - 1))
    if ctx.accepted == {"COMMA", "RPAR"} and ctx.text == ":":
        typed = (ctx.leave_out(ctx.at, ctx.at + 1),) if ctx.text_behind.isidentifier() else ()
        return offering(
            "types are given where variables are declared, as in the rule's head: leave out "
            f"`: {ctx.text_behind}`",
            *typed,
        )
    if ctx.accepted == {"COMMA", "RPAR"} and ctx.text == "(":
        if opened and ctx.text_at(opened - 1).casefold() in ABSOLUTE:
            return NO_ABSOLUTE_VALUE
        return _ARGUMENT
    joins = ctx.text in keywords.PRECEDENCE or ctx.text in (
        *keywords.SYMBOLS.values(),
        *RELATIONS,
    )
    if opened and ctx.accepted == {"COMMA", "RPAR"} and joins:
        named = "".join(token.text for token in ctx.tokens[opened - 1 : ctx.at])
        way_out = f"close the parenthesis after the name: `{named.replace(',', ', ')})`"
        if "," in named:
            return f"an argument is a name: `define` one for what is more, or {way_out}"
        return way_out
    quantifier = _QUANTIFIERS.get(ctx.text_before, "")
    if opened and ctx.accepted == {"COMMA", "RPAR"} and ctx.is_word() and quantifier:
        return f"write `{quantifier} x: {ctx.text} ({ctx.text_at(opened - 1)}(x))`"
    if ctx.accepted == {"COMMA", "RPAR"} and ctx.is_word():
        return offering("separate the names by `,`", ctx.separate(","))
    return ""


def _conditionals(ctx: ParseContext) -> Help:
    text, before = ctx.text, ctx.text_before
    behind = [token.text for token in ctx.tokens[ctx.at :]]
    otherwise = "else" in behind
    then = behind.index("then") if "then" in behind else None
    truths = then is not None and not ctx.is_number(ctx.at + then + 1)
    if (ctx.operator and text == "else") or (text == "if" and ctx.operand and otherwise and truths):
        return "write `(p implies q) and (not p implies r)` for `if p then q else r`"
    if text == "if" and before in ("unless", "when") and not truths:
        return offering("delete the `if`", ctx.leave_out(ctx.at))
    if text == "?" or (otherwise and text == "if"):
        if ctx.operator and text == "if":
            return "a conditional goes in parentheses: `(1.5 m if built_up else 2 m)`"
        return "a conditional is written `(1.5 m if built_up else 2 m)`"
    if text == "if" and ctx.operator:
        return "write `q implies p` for `p if q`"
    if text == "if" or before == "if":
        return "write `p implies q` for `if p then q`"
    if ctx.accepted >= {"ELSE"} and "if" in behind:
        instead = "in place of `,`" if text == "," else f"before `{text}`"
        return f"`else` chains: write it {instead}, as in `3 m if wet else 2 m if dark else 1 m`"
    if ctx.accepted >= {"ELSE"}:
        return "a conditional ends with what holds otherwise: `1.5 m if built_up else 2 m`"
    return ""


def _operators(ctx: ParseContext) -> Help:
    if ctx.unexpected is None:
        return ""
    text, before = ctx.text, ctx.text_before
    if ctx.operator and len(before) > 1 and set(before) <= set(keywords.PREFIX_LETTERS):
        apart = " ".join(before)
        return offering(
            f"`{before}` is read as one name; write `{apart}`", ctx.write(apart, ctx.at - 1)
        )
    if text == "then" and before == "and":
        return "`then` alone separates two phases: write `p then q`"
    if text == "as" and ctx.text_behind == "soon":
        return "for `as soon as p, q` write `always (p implies q)`, or `eventually[<= 2 s] q` in it"
    if ctx.operator and _MEANT.get(before) == "not":
        return offering(f"write `not` or `!` for `{before}`", ctx.write("not", ctx.at - 1))
    word = _MEANT.get(text) or (
        text.casefold() if text.casefold() in keywords.OPERATOR_WORDS else None
    )
    fits = ctx.operand if word in keywords.UNARY_OPERATORS else "AND" in ctx.accepted
    if word is not None and text != word and fits:
        symbol = keywords.SYMBOLS.get(word, word)
        or_symbol = f" or `{symbol}`" if symbol != word else ""
        return offering(f"write `{word}`{or_symbol}", ctx.write_sign(word))
    if "weak" in (before, text):
        return "`weak` comes before `until`, `next` or `previously`"
    if "strong" in (before, text):
        return "`strong` comes before `release`"
    if ctx.operand and text == "{":
        return "a formula goes in parentheses, or alone, but not in braces"
    if ctx.operand and text in RELATIONS and text != "=":
        return "say what is compared, such as `speed <= 50 km/h`"
    return ""


def _joined(ctx: ParseContext) -> Help:
    behind = ctx.token(ctx.at + 1)
    member = behind is not None and behind.kind == "word" and behind.text not in keywords.RESERVED
    if ctx.operator and ctx.text == "." and member and ctx.before and ctx.touches():
        return of_owner(ctx.text_before, ctx.text_behind)
    if ctx.operator and ctx.text == "," and ctx.text_behind in ("unless", "when"):
        clause = ctx.text_behind
        return f"`{clause}` is a clause after the whole formula: put the `)` in place of the `,`"
    more = behind is not None and behind.text not in {")", *keywords.CLAUSE_WORDS}
    if ctx.operator and more and ctx.text in (",", ";", "."):
        return "write `or` where one of them is enough, `and` where it takes all"
    words = (ctx.before, ctx.unexpected)
    is_word = ctx.is_word() and ctx.text not in keywords.RESERVED
    if ctx.operator and ctx.text_before == ")" and is_word:
        return "two formulas are joined by an operator, such as `and`, `or` or `implies`"
    if ctx.operator and all(
        token is not None and token.kind == "word" and token.text not in keywords.RESERVED
        for token in words
    ):
        joined = "two words are joined by an operator, such as `and`"
        if len(ctx.text) == 1:
            of_object = f"{ctx.text_before}({ctx.text})"
            return f"{joined}; what is of an object is written `{of_object}`"
        return f"{joined}, `or` or `implies`; a name is one word"
    return ""


_CLAUSES: Final = ("unless", "when")
_NEGATIONS: Final = ("never", "not", "!")
_ONE_OPERAND: Final = re.compile(r"\s+[^\W\d]\w*(?:\([^()]*\))?\s*\)")
"""A name, perhaps with arguments, and the parenthesis that closes the formula behind it."""


def advise_on_parentheses(ctx: ParseContext) -> Help:
    """Advice on a parenthesis that is not closed, or not opened; empty if there is none."""
    if ctx.unexpected is None and ctx.operator and ctx.opened("(", ")") is not None:
        return _closed_before_a_clause(ctx)
    if ctx.text != ")" or ctx.operand or ctx.quantity or ctx.accepted == {"NAME"}:
        return ""
    if ctx.opened("(", ")") is not None:
        return ""
    return offering("delete the `)`, or open it before", ctx.leave_out(ctx.at))


def opened_earlier(tokens: Sequence[Token], first: int, text: str) -> Token | None:
    """What a `)` in an exception or a condition, from its ``first`` token on, closes before it.

    The clause before it has a mistake then, of which this is a consequence.
    """
    if text != ")" or tokens[first].text not in _CLAUSES:
        return None
    closed = 0
    for token in reversed(tokens[:first]):
        if token.kind == "word" and token.text in keywords.CLAUSE_WORDS:
            return None
        if token.kind == "symbol" and token.text in ("(", ")"):
            closed += 1 if token.text == ")" else -1
            if closed < 0:
                return token
    return None


def _closed_before_a_clause(ctx: ParseContext) -> Help:
    """Help where a clause begins inside an open formula: its keyword may be part of the formula."""
    end = ctx.tokens[-1].end
    behind = ctx.source.text[end:]
    word, *_ = (*behind.split(maxsplit=1), "")
    line = behind.lstrip().partition("\n")[0]
    # On a line of its own, and with no `)` more than it opens, it is a clause as it should be.
    is_clause = "\n" in behind[: behind.find(word)] and line.count(")") <= line.count("(")
    if word not in _CLAUSES or is_clause:
        return offering("close it with `)`", ctx.put_before(")"))
    opened = ctx.opened("(", ")")
    if opened and ctx.tokens[opened - 1].text in _NEGATIONS:
        sign, instead = ("and not", "p and not q") if word == "unless" else ("and", "p and q")
    elif word == "unless":
        sign, instead = "or", "p or q"
    else:
        sign, instead = "", "q implies p"
    start = end + behind.find(word)
    is_one = _ONE_OPERAND.match(ctx.source.text, start + len(word)) is not None
    edit = [write(sign, Span(ctx.source, start, start + len(word)))] if sign and is_one else []
    return offering(
        f"`{word}` is a clause after the whole formula; inside one write `{instead}` for "
        f"`p {word} q`",
        *edit,
    )
