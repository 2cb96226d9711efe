"""Help where a formula is written like a sentence of everyday language."""

from __future__ import annotations

from typing import Final

from rulec.syntax import keywords
from rulec.syntax.messages.parse_context import ParseContext

EGO: Final = ("ego", "self", "this", "me", "host")

_OBLIGATIONS: Final = ("must", "shall", "should", "may", "can")
_CONJUNCTIONS: Final = {
    "before": "for `p before q` write `not q weak until p`",
    "after": "for `q after p` write `not q weak until p`",
    **dict.fromkeys(("while", "whenever"), "for `q while p` write `p implies q`"),
    "only": "for `p only if q` write `p implies q`",
    **dict.fromkeys(("twice", "thrice"), "for `p twice` write `p then not p then p`"),
}
_COMPARING: Final = {
    **dict.fromkeys(("exceeds", "exceed", "exceeding", "above", "over"), ">"),
    **dict.fromkeys(("below", "under"), "<"),
}
_SMALL_WORDS: Final = ("is", "at", "in", "on", "the", "a", "an", "not")


def advise_on_sentence(ctx: ParseContext) -> str:
    """Advice on words that a formula writes otherwise or lacks; empty if there is none."""
    if not ctx.operator or ctx.unexpected is None:
        return ""
    text, before, behind = ctx.text, ctx.text_before, ctx.text_behind
    if before in _OBLIGATIONS:
        return f"leave out `{before}`; what a formula says must hold"
    if text in _OBLIGATIONS and behind == "not":
        return f"for `{text} not p` write `never p`, such as `never (speed > 50 km/h)`"
    if text in _OBLIGATIONS:
        return f"leave out `{text}`: what a formula says must hold, such as `speed <= 50 km/h`"
    if before in EGO and ctx.is_word() and (subject := _predicate(ctx)):
        return f"what is about ego is written alone: `{subject}`"
    if text in _CONJUNCTIONS:
        return _CONJUNCTIONS[text]
    if text in _COMPARING and behind:
        return f"for `{text}` write `{_COMPARING[text]}`"
    plural = len(before) > 2 and before.endswith("s") and before not in keywords.RESERVED
    if ctx.is_number(ctx.at - 2) and plural and text.isidentifier():
        number, singular = ctx.text_at(ctx.at - 2), before[:-1]
        return f"how many is said by `count x: {singular} ({text}(x)) >= {number}`"
    return ""


def _predicate(ctx: ParseContext) -> str:
    """What is stated about ego: `junction` in `ego is at the junction`."""
    words = (token.text for token in ctx.tokens[ctx.at :])
    subject = next((word for word in words if word not in _SMALL_WORDS), "")
    return subject if subject.isidentifier() and subject not in keywords.RESERVED else ""
