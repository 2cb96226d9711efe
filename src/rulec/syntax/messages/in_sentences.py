"""Help where a formula is written like a sentence of everyday language."""

from __future__ import annotations

from typing import Final

from rulec.diagnostics.ways_out import Help, offering
from rulec.syntax import keywords
from rulec.syntax.messages.parse_context import ParseContext

EGO: Final = ("ego", "self", "this", "me", "host")

_OBLIGATIONS: Final = ("must", "shall", "should", "may", "can")
_CONJUNCTIONS: Final = {
    "before": "for `p before q` write {}",
    "after": "for `q after p` write {}",
    **dict.fromkeys(("while", "whenever"), "for `q while p` write `p implies q`"),
    "only": "for `p only if q` write `p implies q`",
    **dict.fromkeys(("twice", "thrice"), "for `p twice` write `p then not p then p`"),
}
_IN_ORDER_OF_TIME: Final = {
    False: "`not q weak until p`",
    True: "`q implies previously once p`",
}
"""How what comes first is said of whole traces, and of any one state, as within `always`.

With `always` before it, the first would also ask for it anew in every later state.
"""
_COMPARING: Final = {
    **dict.fromkeys(("exceeds", "exceed", "exceeding", "above", "over"), ">"),
    **dict.fromkeys(("below", "under"), "<"),
}
_IN_PAIRS: Final = {
    "neither": ("nor", "for `neither p nor q` write `not (p or q)`"),
    "either": ("or", "delete `either`: `or` says it; if only one of them may be so, write `xor`"),
    "both": ("and", "delete `both`: `and` says it"),
}
_CONDITIONS: Final = ("whenever", "while", "where", "wherever")
_SMALL_WORDS: Final = ("is", "at", "in", "on", "the", "a", "an", "not")


def advise_on_sentence(ctx: ParseContext) -> Help:
    """Advice on words that a formula writes otherwise or lacks; empty if there is none."""
    if not ctx.operator or ctx.unexpected is None:
        return ""
    text, before, behind = ctx.text, ctx.text_before, ctx.text_behind
    if before in _OBLIGATIONS:
        return offering(
            f"leave out `{before}`; what a formula says must hold", ctx.leave_out(ctx.at - 1)
        )
    if text in _OBLIGATIONS and behind == "not":
        return f"for `{text} not p` write `never p`, such as `never (speed > 50 km/h)`"
    if text in _OBLIGATIONS:
        return offering(
            f"leave out `{text}`: what a formula says must hold, such as `speed <= 50 km/h`",
            ctx.leave_out(ctx.at),
        )
    if before in EGO and ctx.is_word() and (subject := _predicate(ctx)):
        return f"what is about ego is written alone: `{subject}`"
    if text in _CONJUNCTIONS:
        return _CONJUNCTIONS[text].format(_IN_ORDER_OF_TIME[_in_every_state(ctx)])
    if text in _COMPARING and behind:
        return offering(f"for `{text}` write `{_COMPARING[text]}`", _COMPARING[text])
    plural = len(before) > 2 and before.endswith("s") and before not in keywords.RESERVED
    if ctx.is_number(ctx.at - 2) and plural and text.isidentifier():
        number, singular = ctx.text_at(ctx.at - 2), before[:-1]
        return f"how many is said by `count x: {singular} ({text}(x)) >= {number}`"
    return ""


def _in_every_state(ctx: ParseContext) -> bool:
    """Whether the place is within `always` or `never`."""
    return any(token.text in ("always", "never", "G") for token in ctx.tokens[: ctx.at])


def advise_on_pair(ctx: ParseContext) -> Help:
    """Help at what follows `neither`, `either`, `both` or `whenever`, which read as names."""
    if ctx.operator and ctx.text_before in _CONDITIONS:
        return f"write `p implies q` for `{ctx.text_before} p then q`"
    second, way_out = _IN_PAIRS.get(ctx.text_before, ("", ""))
    behind = (token.text for token in ctx.tokens[ctx.at :])
    if not (ctx.operator and second in behind):
        return ""
    is_idle = ctx.text_before != "neither"
    return offering(way_out, *((ctx.leave_out(ctx.at - 1),) if is_idle else ()))


def of_owner(owner: str, what: str) -> str:
    """How what is of ego or of an object is written."""
    if owner in EGO:
        return f"what is about ego is written alone: `{what}`"
    return f"what is of an object is written `{what}({owner})`"


def _predicate(ctx: ParseContext) -> str:
    """What is stated about ego: `junction` in `ego is at the junction`."""
    words = (token.text for token in ctx.tokens[ctx.at :])
    subject = next((word for word in words if word not in _SMALL_WORDS), "")
    return subject if subject.isidentifier() and subject not in keywords.RESERVED else ""
