"""Messages about pieces that cannot be parsed: exactly one for each."""

from __future__ import annotations

from bisect import bisect_left

from rulec.diagnostics import Diagnostic, Label, Source, Span
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import Help, another_name, left_out, meant, offering, put
from rulec.syntax import keywords
from rulec.syntax.file_pieces import Piece, span_of
from rulec.syntax.messages.advice import advise
from rulec.syntax.messages.decimal_points import point_fix
from rulec.syntax.messages.in_formulas import no_operator, opened_earlier
from rulec.syntax.messages.in_items import other_clause, other_word
from rulec.syntax.messages.other_scripts import advise_on_mark
from rulec.syntax.messages.parse_context import (
    COMMENT,
    DELETE_IT,
    ParseContext,
    in_words,
    is_comment,
    is_invisible,
)
from rulec.syntax.parse_nodes import MAX_DEPTH, Mismatch
from rulec.syntax.scanner import Token

UNEXPECTED_WORD = Code("R0104")

UNTERMINATED_TEXT = Code("R0105")

FORMULA_TOO_DEEP = Code("R0111")

RESERVED_WORD = Code("R0113")


_LINES = (
    *("title", "law", "use", "extends", "traffic", "semantics", "step", "priority"),
    *("constant", "presumed"),
    *("drop", "soften", "silent", "rulebook", "vocabulary"),
)
_WHAT = {
    **{word: f"the `{word}` line" for word in _LINES},
    **{word: f"the declaration of a {word}" for word in ("type", "signal", "quantity")},
    **{word: f"the {word}" for word in ("fact", "option")},
    **{word: f"`{word}`" for word in ("cite", "says", "source", "certainty")},
    **dict.fromkeys(("define", "redefine"), "the definition"),
    **dict.fromkeys(("accept", "reject"), "the example"),
    **{word: f"the list of {word}" for word in ("topics", "provisions")},
    "topic": "`topic`",
    "param": "the parameter",
    "set": "the setting",
    "in": "`in force`",
    "when": "the condition",
    "unless": "the exception",
    "also": "the exception",
    "require": "the formula",
}
_CLAUSE_BEGINS = keywords.CLAUSE_WORDS | {"throughout", "initially"}
"""Words that may come first on a line of a rule: clauses, and the scope of an exception."""

_BY_KIND = {"rule_head": "the rule's head", "state": "the state", "formula": "the formula"}


def explain(source: Source, tokens: list[Token], piece: Piece, mismatch: Mismatch) -> Diagnostic:
    # A rulebook's name is a name, as far as messages are concerned.
    accepted = frozenset("NAME" if kind == "BOOK" else kind for kind in mismatch.accepted)
    inside = tokens[piece.first : piece.last]
    at = bisect_left([token.end for token in inside], mismatch.position + 1)
    token = inside[at] if at < len(inside) else None
    ctx = ParseContext(source, piece.kind, inside, at, accepted)
    first = ctx.first
    end = span_of(source, tokens, piece).end
    span = Span(source, end, end) if token is None else _span(source, token)
    if token is not None and token.kind == "unterminated":
        return _unterminated(span)
    if token is not None and _is_word_for_name(ctx):
        return _reserved(span, token.text, ctx)
    if piece.kind == "item" and at < 2 and first not in keywords.ITEM_WORDS:
        return _unknown_item(source, inside)
    if found := no_operator(ctx):
        word, way_out = found
        return UNEXPECTED_WORD.at(
            _span(source, inside[word]),
            f"no operator is called `{_short(inside[word].text)}`",
            expected="expected an operator such as `never`",
            help=way_out,
        )
    subject = _BY_KIND.get(piece.kind) or _WHAT.get(first, "the declaration")
    begins = at == (first == "require")
    if token is None:
        message = f"{subject} is empty" if begins else f"{subject} ends too early"
    elif begins:
        message = f"{subject} cannot begin with `{_short(token.text)}`"
    else:
        message = f"{subject} cannot go on with `{_short(token.text)}`"
    if token is not None and (opened := opened_earlier(tokens, piece.first, token.text)):
        return UNEXPECTED_WORD.at(
            span,
            message,
            help=f"it follows from the mistake before `{first}`, and goes when that is mended",
            labels=(Label(_span(source, opened).place, "it closes this"),),
        )
    return UNEXPECTED_WORD.at(
        span,
        message,
        expected=in_words(accepted),
        help=_certain_of_nothing(ctx) if "UNVERIFIED" in accepted else advise(ctx),
        labels=_open_parenthesis(source, ctx),
        fix=point_fix(ctx),
    )


def _certain_of_nothing(ctx: ParseContext) -> Help:
    """Help at a certainty: more than `unverified` is to be found out, and not written."""
    offers = () if ctx.unexpected is None else ("unverified",)
    return offering(str(advise(ctx)), *offers)


def unknown_clause(source: Source, tokens: list[Token], piece: Piece) -> Diagnostic:
    token = tokens[piece.first]
    others = tokens[piece.first + 1 : piece.last]
    symbols = any(token.kind == "symbol" for token in (token, *others))
    formula: Help = "a formula follows `require`" if symbols else ""
    words = frozenset(token.text for token in others)
    if token.kind == "word" and "{" in words:
        formula = 'an example is written `accept "…" { … }` or `reject "…" { … }`'
    if token.text in keywords.ITEM_WORDS:
        formula = f"`{token.text}` stands outside of rules, on a line of its own"
    if token.text == "{":
        formula = "the states of an example go between one `{` and `}`, with `;` between them"
    if is_comment((token, *others), 0):
        formula = COMMENT
    if others and is_invisible(others[0].text) and others[0].start == token.end:
        # Where word processors may break a line: the word goes on behind it.
        hidden = _span(source, others[0])
        formula = offering(f"after `{_short(token.text)}`, {DELETE_IT}", left_out(hidden))
    other: Help = other_clause(token.text, words)
    if token.text == ";":
        other = offering(str(other), left_out(_span(source, token)))
    return UNEXPECTED_WORD.at(
        _span(source, token),
        f"no clause begins with `{_short(token.text)}`",
        expected="expected a clause such as `require` or `accept`",
        help=other or meant(token.text, _CLAUSE_BEGINS) or formula,
    )


def _unknown_item(source: Source, inside: list[Token]) -> Diagnostic:
    token, *others = inside
    way_out: Help = ""
    if token.kind == "word":
        way_out = other_word(token.text) or meant(
            token.text, keywords.ITEM_WORDS | keywords.CLAUSE_WORDS
        )
        named = any(
            token.kind == "word" and token.text not in keywords.RESERVED for token in others[:1]
        )
        if others and others[0].text in ("=", ":="):
            way_out = way_out or f"write `param {token.text} = …` or `define {token.text} = …`"
        if not (way_out or named or token.text in keywords.RESERVED):
            way_out = f"an enumeration is declared by `{token.text} is one of a, b`"
        if others and others[0].start == token.end:
            way_out = advise_on_mark(source, others[0]) or way_out
    if is_comment(inside, 0):
        way_out = COMMENT
    if is_invisible(token.text):
        way_out = offering(DELETE_IT, left_out(_span(source, token)))
    return UNEXPECTED_WORD.at(
        _span(source, token),
        f"nothing in the language begins with `{_short(token.text)}`",
        expected="expected a declaration or a rule",
        help=way_out,
    )


def too_deep(span: Span) -> Diagnostic:
    return FORMULA_TOO_DEEP.at(
        span,
        f"the formula has more than {MAX_DEPTH} levels: parts inside others, or joined to others",
        help="split it into several rules",
    )


def too_long(span: Span, limit: int) -> Diagnostic:
    return FORMULA_TOO_DEEP.at(
        span,
        f"this goes on for more than {limit:,} words and signs",
        help="split it into several parts",
    )


def too_many_states(span: Span, number: int, limit: int) -> Diagnostic:
    return FORMULA_TOO_DEEP.at(
        span,
        f"the example has {number:,} states, and at most {limit:,} are read",
        help="tell the moments that matter; `rulec verify` judges whole drives, as traces in a "
        "file of their own",
    )


def _span(source: Source, token: Token) -> Span:
    return Span(source, token.start, token.end)


def _short(text: str) -> str:
    if is_invisible(text):
        return f"U+{ord(text):04X}"
    return text if len(text) <= 40 else f"{text[:39]}…"


def _is_word_for_name(ctx: ParseContext) -> bool:
    token = ctx.unexpected
    if token is None or token.kind != "word" or token.text not in keywords.RESERVED:
        return False
    if "NAME" not in ctx.accepted:
        return False
    if token.text in ("because", "rule") and ctx.first in keywords.PROVISION_WORDS:
        return False  # the name before it is missing, or `rule` stands where it need not
    if ctx.operand or ctx.quantity:
        return token.text in keywords.ITEM_WORDS | keywords.CLAUSE_WORDS
    return ctx.kind != "state" or token.text in keywords.ITEM_WORDS | keywords.CLAUSE_WORDS


def _reserved(span: Span, word: str, ctx: ParseContext) -> Diagnostic:
    kind = "an operator" if word in keywords.OPERATOR_LETTERS else "a word of the language"
    another: Help = offering(f"choose another name, such as `{word.lower()}_1`", another_name(span))
    if ctx.kind == "rule_head" and word == "every" and ctx.text_before in ("(", ","):
        another = offering(
            "leave `every` out: a rule holds for every one, as in `(v: vehicle)`", left_out(span)
        )
    if ctx.kind == "rule_head" and word == "some" and ctx.text_before in ("(", ","):
        another = "a rule holds for every one; of some speaks its formula: `some v: vehicle (…)`"
    if ctx.operand and word in ("when", "unless"):
        other = "not p" if word == "unless" else "p"
        another = f"in a formula write `{other} implies q`; of a whole rule it is a clause"
    return RESERVED_WORD.at(
        span,
        f"`{word}` is {kind} and cannot be a name",
        expected="expected a name",
        help=another,
    )


def _unterminated(span: Span) -> Diagnostic:
    text = span.source.text[span.start : span.end]
    first, *more = text.splitlines()
    end = span.start + len(first)
    closed = put('Put `"` behind it', '"', span, end)
    return UNTERMINATED_TEXT.at(
        Span(span.source, span.start, end),
        "this text does not end on its line" if more else "this text has no closing quote",
        expected='expected `"` before the end of the line',
        help=offering(
            "write all of it on one line, however long"
            if more
            else "close it on the same line; texts do not run over a line's end",
            closed,
        ),
    )


def _open_parenthesis(source: Source, ctx: ParseContext) -> tuple[Label, ...]:
    signs = {"RPAR": ("(", ")"), "RSQB": ("[", "]")}
    for kind, (opening, closing) in signs.items():
        opened = ctx.opened(opening, closing) if kind in ctx.accepted else None
        if opened is not None and ctx.kind in ("clause", "formula", "item", "rule_head"):
            place = _span(source, ctx.tokens[opened]).place
            return (Label(place, "this is still open"),)
    return ()
