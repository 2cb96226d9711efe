"""The compiler without Spot, as the worker uses it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.automata.compiler_jobs import Compiler, Job, Translated
from rulec.automata.decision_diagrams.rule_automaton import (
    RuleAutomaton,
    automaton_of,
    contradicts,
    over_letters,
)


def _translated(job: Job) -> Translated:
    rule_automaton = automaton_of(
        job.formula, job.reads, job.semantics, [group.known for group in job.groups]
    )
    automaton, possible = over_letters(rule_automaton, job.reads)
    return Translated(
        automaton,
        possible,
        in_hoa(rule_automaton, job.name, job.comments(rule_automaton.alive)),
    )


COMPILER = Compiler("", _translated, contradicts)


def in_hoa(automaton: RuleAutomaton, name: str, comments: Sequence[str]) -> str:
    """The automaton's text, with these comments.

    A finite word is encoded by an extra proposition that is false from its end on.
    """
    states = automaton.automaton
    alive = [] if automaton.alive is None else [automaton.alive]
    propositions = sorted([*automaton.names.values(), *alive])
    rows = list(_rows(automaton, {text: str(place) for place, text in enumerate(propositions)}))
    acceptance = _acceptance(
        states.n_marks, [bool(states.accepts(n)) for n in range(1 << states.n_marks)]
    )
    is_buchi = acceptance == "Inf(0)"
    head = [
        "HOA: v1",
        *comments,
        f"name: {_quoted(name)}",
        f"States: {len(rows)}",
        "Start: 0",
        " ".join(["AP:", str(len(propositions)), *map(_quoted, propositions)]),
        *(["acc-name: Buchi"] if is_buchi else []),
        f"Acceptance: {states.n_marks} {acceptance}",
        "properties: trans-labels explicit-labels trans-acc deterministic complete",
        "--BODY--",
    ]
    body = [line for state, row in enumerate(rows) for line in (f"State: {state}", *row)]
    return "\n".join([*head, *body, "--END--"]) + "\n"


def _rows(rule_automaton: RuleAutomaton, numbers: dict[str, str]) -> Iterator[list[str]]:
    """The lines of each state's edges."""
    automaton, alive = rule_automaton.automaton, rule_automaton.alive
    size = len(automaton.edges)
    lost, ended = size, size + 1
    for state, row in enumerate(automaton.edges):
        lines = []
        for (target, marks), letters in row.items():
            cubes = [
                cube if alive is None else {**cube, alive: True}
                for cube in rule_automaton.diagrams.cubes(letters)
            ]
            lines.append(_line(cubes, numbers, target, marks))
        if alive is not None and automaton.ends_well is not None:
            over = ended if automaton.ends_well[state] else lost
            lines.append(_line([{alive: False}], numbers, over, 0))
        yield lines
    if alive is not None:
        yield [_line([{}], numbers, lost, 0)]
        yield [
            _line([{alive: False}], numbers, ended, 1),
            _line([{alive: True}], numbers, lost, 1),
        ]


def _line(
    cubes: Sequence[dict[str, bool]], numbers: dict[str, str], target: int, marks: int
) -> str:
    texts = [
        "&".join([f"{'' if value else '!'}{numbers[name]}" for name, value in cube.items()]) or "t"
        for cube in cubes
    ]
    own = [str(mark) for mark in range(marks.bit_length()) if marks >> mark & 1]
    marked = f" {{{' '.join(own)}}}" if own else ""
    return f"[{' | '.join(texts)}] {target}{marked}"


def _acceptance(n_marks: int, accepted: Sequence[bool]) -> str:
    """The acceptance condition for which sets of recurring marks (as bits) are ``accepted``."""
    if all(accepted):
        return "t"
    if n_marks == 1:
        return "Inf(0)" if accepted[1] else "Fin(0)" if accepted[0] else "f"
    cases = [
        "&".join([f"{'Inf' if marks >> n & 1 else 'Fin'}({n})" for n in range(n_marks)])
        for marks, is_accepted in enumerate(accepted)
        if is_accepted
    ]
    return " | ".join(f"({case})" for case in cases) or "f"


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
