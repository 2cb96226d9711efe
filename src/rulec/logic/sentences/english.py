"""English."""

from __future__ import annotations

import re

from rulec.logic.formula import BinaryOperator, UnaryOperator
from rulec.logic.sentences.language import (
    Language,
    SpanWords,
    TypeWords,
)


def plural(noun: str) -> str:
    """The plural of a type's name, by the rules for regular nouns."""
    if re.search(r"(s|x|ch|sh|z)$", noun):
        return f"{noun}es"
    return f"{noun[:-1]}ies" if re.search(r"[^aeiou]y$", noun) else f"{noun}s"


ENGLISH = Language(
    code="en",
    quoted="“{}”",
    inner_joints=re.compile(r",| and | or "),
    no_pause_after=("that", "which", ":", ","),
    runs_on=("it ", "there "),
    and_="and",
    or_="or",
    then="then",
    the_name="the {}",
    the_name_of="the {} of {}",
    value=("{} is “{}”", "{} is not “{}”"),
    value_is="{} is {}",
    atom=("“{}” holds", "“{}” does not hold"),
    constants=("anything may be the case", "the impossible is the case"),
    atom_of=("“{}” holds of {}", "“{}” does not hold of {}"),
    truth=("“{}” is true", "“{}” is not true"),
    same=("{} is the same as {}", "{} is not the same as {}"),
    kind=("{} is {}", "{} is not {}"),
    relations={
        "<": ("{} is less than {}", "{} is not less than {}"),
        "<=": ("{} is at most {}", "{} is not at most {}"),
        "=": ("{} is exactly {}", "{} is not exactly {}"),
        "!=": ("{} differs from {}", "{} does not differ from {}"),
        ">=": ("{} is at least {}", "{} is not at least {}"),
        ">": ("{} is more than {}", "{} is not more than {}"),
    },
    times="times",
    counted={
        "<": "fewer than {}",
        "<=": "at most {}",
        "=": "exactly {}",
        "!=": "any number other than {}",
        ">=": "at least {}",
        ">": "more than {}",
    },
    there_is="there is {} {} for which",
    there_is_no="there is {} {} for which",
    there_are="there are {} {} for which",
    number_of="the number of {} {} (for which {})",
    type_words=TypeWords(
        every="every {}", other="every other {}", one="a {}", none="no {}", noun="{}", plural="{}"
    ),
    plural=plural,
    for_every="for {}: ",
    step="step",
    steps="steps",
    span=SpanWords("{} or more", "up to {}", "from {} to {}", "exactly {}"),
    later="later",
    after_start="after the start",
    before="earlier",
    lasting=SpanWords("for at least {}", "for at most {}", "for {} to {}", "for exactly {}"),
    at_start="{} at the start",
    there_at_start="at the start {}",
    stretches={
        "initially": "at the start of the trace",
        "at start": "at the start of the time that the rule is about",
        "throughout": "throughout the time that the rule is about",
        "at some point": "at some point of the time that the rule is about",
        "at end": "at the end of the time that the rule is about",
    },
    exempt="it does not count if, {},",
    counts_only="it counts only if, {},",
    counts_never="it never counts, for its condition is false as options are set",
    not_so="it is not the case that",
    adverbs={
        UnaryOperator.ALWAYS: "[at all times {}|at all times|from that time on always]",
        UnaryOperator.NEVER: "[at no time {} does it happen|it never happens|from that time on it "
        "never happens] that",
        UnaryOperator.EVENTUALLY: "at [some time {}|some time|that time or later]",
        UnaryOperator.NEXT: "[{}|at the next moment]",
        UnaryOperator.WEAK_NEXT: "[{}, if the trace lasts that long|at the next moment, if there "
        "is one],",
        UnaryOperator.ONCE: "at [some time {}|the start or earlier|that time or earlier],",
        UnaryOperator.HISTORICALLY: "[at all times {},|up to the start always|up to that time "
        "always]",
        UnaryOperator.PREVIOUSLY: "[{}|one moment earlier],",
        UnaryOperator.WEAK_PREVIOUSLY: "[{}, if the trace had begun|one moment earlier, if there "
        "was one],",
    },
    binary={
        BinaryOperator.UNTIL: "{left} until, [sooner or later|at some time {span}], {right}",
        # Of what does not hold, `for ever` alone would say that it may hold some day.
        BinaryOperator.WEAK_UNTIL: "{left}, and this is so [for ever|at all times {first}|for "
        "ever], or only until, at some time[| {span}], {right}",
        BinaryOperator.RELEASE: "unless released before by a moment at which {left}, at all "
        "times[| {span}] {right}",
        BinaryOperator.STRONG_RELEASE: "unless released before by a moment, which must come[| "
        "{first}|], at which {left}, at all times[| {span}] {right}",
        BinaryOperator.SINCE: "{left}, and this has been so ever since [|a moment {span} at which "
        "]{right}",
    },
    iff="{} if and only if {}",
    xor="either {} or {}, but not both",
    implies="if {}, then {}",
    means="{} if and only if {}",
    where="{}, where:",
    either="either {}",
    both="both {}",
    all_="all of this is so: {}",
    both_of="both of these hold:",
    all_of="all of these hold:",
    one_of="at least one of these holds:",
    none_of="none of these holds:",
    phase_line="without a break first{}",
    phase=" {}",
    phase_joint=", then",
    lasting_phase=" {} {}",
    lasting_item="{}: {}",
    phases="these phases follow one another without a break, each for at least one moment:",
)
