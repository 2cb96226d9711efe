"""The answer to a job: a machine that was compared with its formula, or why there is none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from rulec.automata.alphabet import count_letters, letters_with, propositions_of
from rulec.automata.axiom_groups import AxiomGroup
from rulec.automata.compiler_jobs import (
    MOST_OPERATORS,
    MOST_STEPS_AHEAD,
    AcceptanceError,
    BeyondReachError,
    CheckError,
    Compiler,
    Done,
    Failed,
    Job,
    SizeError,
    Translated,
)
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor
from rulec.automata.tables import build_machine
from rulec.automata.worker.random_words import agrees, outlined
from rulec.logic.bounds import operations_of
from rulec.logic.codec import from_data, to_data
from rulec.logic.fold import bit_sets, fold
from rulec.logic.formula import Binary, BinaryOperator, Formula, Unary
from rulec.rulebook.rules.axiom_instances import AxiomInstance
from rulec.validation.table_proof import prove_words
from rulec.validation.unprovable import UnprovableError


def answer_to(job: Job, compiler: Compiler) -> Done | Failed:
    """The machine of a job, or the reason why there is none."""
    if count_letters(job.reads) > job.most_letters:
        return Failed("letters")
    if _farthest_step(job.formula) > MOST_STEPS_AHEAD:
        return Failed("steps")
    if _written_out(job.formula) > MOST_OPERATORS:
        return Failed("size")
    for group in job.groups:
        if compiler.contradicts(group.known):
            return Failed("facts", contradiction=_contradiction(group, compiler))
    try:
        translated = compiler.translate(job)
    except CheckError:
        return Failed("check")
    except BeyondReachError:
        return Failed("reach")
    except SizeError:
        return Failed("size")
    except AcceptanceError:
        return Failed("sets")
    machine = build_machine(translated.automaton, job.reads, translated.possible)
    try:
        return (
            Done(machine, translated.hoa)
            if _is_right(machine, job, translated)
            else Failed("check")
        )
    except CheckError:
        return Failed("check")


def _farthest_step(formula: Formula) -> Fraction:
    """The greatest step number in any bound of a formula in steps."""
    bounds = [operation.bound for operation in operations_of(formula)]
    ends = [bound.high or bound.low for bound in bounds if bound is not None]
    return max(ends, default=Fraction(0))


def _written_out(formula: Formula) -> int:
    """The number of operators and propositions of a formula with each `then` written out."""
    match formula:
        case Unary(_, operand):
            return 1 + _written_out(operand)
        case Binary(operator, left, right):
            times = 2 if operator is BinaryOperator.THEN else 1
            return 1 + times * _written_out(left) + _written_out(right)
    return 1


def _contradiction(group: AxiomGroup, compiler: Compiler) -> tuple[AxiomInstance, ...]:
    needed = group
    for instance in group.instances:
        without = tuple(other for other in needed.instances if other is not instance)
        fewer = replace(needed, instances=without)
        if compiler.contradicts(fewer.known):
            needed = fewer
    return needed.instances


def _is_right(machine: MealyMonitor, job: Job, translated: Translated) -> bool:
    """Whether a machine judges words as its job's formula does.

    This is proved for all words. If the proof takes too long, the compiler compares its automaton
    with the formula as far as it can; unless that is complete, the machine is tested on random
    words. Raises CheckError as ``found.compare``.
    """
    try:
        _prove(machine, job)
    except RecursionError:
        pass
    except UnprovableError as problem:
        if problem.word:
            return False
    else:
        return True
    if translated.compare is not None:
        translated.compare()
    return translated.is_checked or agrees(machine, job.formula, job.semantics)


def _prove(machine: MealyMonitor, job: Job) -> None:
    """Raise UnprovableError unless a machine judges all words as its formula does."""
    everything = (1 << len(machine.letters)) - 1
    of_letters = bit_sets(letters_with(machine.reads, propositions_of(job.formula)), everything)
    outline, parts = outlined(job.formula)
    true_in = {atom: fold(part, of_letters) for part, atom in parts.items()}
    # Letters that neither the formula nor the table tells apart count as one: these are few.
    groups = list(enumerate(_classes_of(machine.letters)))
    for letters in true_in.values():
        halves = [
            (number, members & side)
            for number, members in groups
            for side in (letters, everything ^ letters)
        ]
        groups = [half for half in halves if half[1]]
    places: dict[Formula, int] = {
        atom: sum([1 << place for place, (_, members) in enumerate(groups) if members & letters])
        for atom, letters in true_in.items()
    }
    prove_words(
        to_data(outline),
        lambda atom: places[from_data(atom)],
        {
            "letters": [number for number, _ in groups],
            "following": machine.successors,
            "accepting": machine.outputs,
            "dead": machine.rejecting_sink,
            "safe": machine.accepting_sink,
        },
        ends=job.semantics == "finite",
    )


def _classes_of(letters: Sequence[int]) -> list[int]:
    """The letters of each class, as bits."""
    rows = [bytearray(len(letters) // 8 + 1) for _ in range(max(letters) + 1)]
    for letter, number in enumerate(letters):
        if number != IMPOSSIBLE:
            rows[number][letter // 8] |= 1 << letter % 8
    return [int.from_bytes(row, "little") for row in rows]
