"""The operators of time in plain English."""

from __future__ import annotations

from dataclasses import replace

from rulec.logic.english.atom_phrases import span
from rulec.logic.formula import BinaryOperator, Bound, UnaryOperator


def adverb(operator: UnaryOperator, bound: Bound | None, *, inside: bool) -> str:
    """The words before what holds at another time, or at other times.

    ``inside``: they are not seen from the start of the trace, but from a time named before.
    """
    later = "later" if inside else "after the start"
    here = "that time" if inside else "the start"
    match operator, bound:
        case UnaryOperator.ALWAYS, None:
            return "from that time on always" if inside else "at all times"
        case UnaryOperator.ALWAYS, Bound():
            return f"at all times {span(bound, later)}"
        case UnaryOperator.NEVER, None:
            return f"{'from that time on ' if inside else ''}it never happens that"
        case UnaryOperator.NEVER, Bound():
            return f"at no time {span(bound, later)} does it happen that"
        case UnaryOperator.EVENTUALLY, None:
            return "at that time or later" if inside else "at some time"
        case UnaryOperator.EVENTUALLY, Bound():
            return f"at some time {span(bound, later)}"
        case UnaryOperator.NEXT, None:
            return "at the next moment"
        case UnaryOperator.NEXT, Bound():
            return span(bound, later)
        case UnaryOperator.WEAK_NEXT, None:
            return "at the next moment, if there is one,"
        case UnaryOperator.WEAK_NEXT, Bound():
            return f"{span(bound, later)}, if the trace lasts that long,"
        case UnaryOperator.ONCE, None:
            return f"at {here} or before"
        case UnaryOperator.ONCE, Bound():
            return f"at some time {span(bound, 'before')}"
        case UnaryOperator.HISTORICALLY, None:
            return f"up to {here} always"
        case UnaryOperator.HISTORICALLY, Bound():
            return f"at all times {span(bound, 'before')}"
        case UnaryOperator.PREVIOUSLY, None:
            return "at the moment before"
        case UnaryOperator.PREVIOUSLY, Bound():
            return span(bound, "before")
        case UnaryOperator.WEAK_PREVIOUSLY, None:
            return "at the moment before, if there was one,"
        case UnaryOperator.WEAK_PREVIOUSLY, Bound():
            return f"{span(bound, 'before')}, if the trace had begun,"
    raise AssertionError(f"{operator} is not about another time")


def pattern_of(operator: BinaryOperator, bound: Bound | None, *, inside: bool) -> str:
    """The pattern of a binary operator's phrase, left operand first."""
    later = "later" if inside else "after the start"
    when = "" if bound is None else f" at some time {span(bound, later)}"
    always = "at all times" if bound is None else f"at all times {span(bound, later)}"
    end = None if bound is None or bound.high is None else bound.high
    first = "" if bound is None or end is None else span(replace(bound, low=end * 0), later)
    match operator:
        case BinaryOperator.UNTIL if bound is None:
            return "{} until, sooner or later, {}"
        case BinaryOperator.UNTIL:
            return f"{{}} until,{when}, {{}}"
        case BinaryOperator.WEAK_UNTIL:
            ever = f"at all times {first}" if first else "for ever"
            return f"{{}} {ever}, or only until,{when or ' at some time'}, {{}}"
        case BinaryOperator.RELEASE:
            return f"unless released before by a moment at which {{}}, {always} {{}}"
        case BinaryOperator.STRONG_RELEASE:
            come = f", which must come {first}," if first else ", which must come,"
            return f"unless released before by a moment{come} at which {{}}, {always} {{}}"
        case BinaryOperator.SINCE:
            before = "" if bound is None else f" a moment {span(bound, 'before')} at which"
            return f"{{}} ever since{before} {{}}"
    raise ValueError(f"{operator} is no operator of time with a phrase")
