"""The answer to a job: a machine that was compared with its formula, or why there is none."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction

from rulec.automata.alphabet import count_letters, letters_with, propositions_of
from rulec.automata.axiom_groups import AxiomGroup
from rulec.automata.compiler_jobs import (
    MOST_LETTERS,
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
from rulec.automata.tables import build_machine, rows_of
from rulec.automata.worker.random_words import agrees, outlined
from rulec.automata.worker.register_product import MOST_REGISTERS, Skeleton, with_registers
from rulec.logic.bounds import operations_of
from rulec.logic.codec import from_data, to_data
from rulec.logic.fold import bit_sets, fold
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Formula,
    Proposition,
    Unary,
    with_operands,
)
from rulec.logic.past_registers import eliminate_past
from rulec.logic.pastification import pastified
from rulec.logic.semantics import Semantics
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
        return _by_registers(job, compiler) or _whole(job, compiler)
    except CheckError:
        return Failed("check")
    except BeyondReachError:
        return Failed("reach")
    except SizeError:
        return Failed("size")
    except AcceptanceError:
        return Failed("sets")


def _whole(job: Job, compiler: Compiler) -> Done:
    """The answer by translating the whole formula."""
    translated = compiler.translate(job)
    every = (1 << count_letters(job.reads)) - 1
    possible = every if translated.possible is None else translated.possible
    machine = build_machine(rows_of(translated.automaton, possible), job.reads)
    outline, parts = outlined(job.formula)
    propositions = letters_with(job.reads, propositions_of(job.formula))
    claim = _Claim(machine, outline, _letters_of(parts, propositions, every), job.semantics)
    if not _is_right(claim, translated, lambda: agrees(machine, job.formula, job.semantics)):
        raise CheckError
    return Done(machine, translated.hoa)


def _by_registers(job: Job, compiler: Compiler) -> Done | None:
    """The answer by translating what remains of a formula once its past is in registers.

    So are bounded duties, as conditions on the past, unless their registers have too many states
    together. None if the compiler does not do so, the automaton's text is wanted, or there is no
    such rest.
    """
    if compiler.rest is None or job.remarks:
        return None
    past, possible = pastified(job.formula, job.semantics), compiler.possible(job)
    skeleton = None if past is None else _skeleton(past, job, possible)
    if skeleton is not None:
        with suppress(SizeError):
            return _beside_registers(skeleton, job, compiler)
    skeleton = _skeleton(job.formula, job, possible)
    return None if skeleton is None else _beside_registers(skeleton, job, compiler)


def _beside_registers(skeleton: Skeleton, job: Job, compiler: Compiler) -> Done:
    """The answer by the small table of a skeleton, which runs beside its registers."""
    assert compiler.rest is not None, "it has been asked whether there is one"
    letters = skeleton.letters_with
    translated = compiler.rest(job, skeleton.rest, letters, skeleton.n_letters)
    small = build_machine(rows_of(translated.automaton, skeleton.possible), (), skeleton.n_letters)
    rows = with_registers(small, skeleton, ends=job.semantics == "finite")
    machine = build_machine(rows, job.reads)
    claim = _Claim(small, skeleton.present, letters, job.semantics)
    if not _is_right(claim, translated, lambda: agrees(machine, job.formula, job.semantics)):
        raise CheckError
    return Done(machine, "")


def _skeleton(formula: Formula, job: Job, possible: int | None) -> Skeleton | None:
    outline, parts = outlined(formula)
    past = eliminate_past(outline)
    if past.memories or len(past.registers) > MOST_REGISTERS:
        return None
    every = (1 << count_letters(job.reads)) - 1
    propositions = letters_with(job.reads, propositions_of(job.formula))
    true_in = _letters_of(parts, propositions, every)
    groups = _split([every if possible is None else possible], true_in.values())
    groups.sort(key=lambda letters: letters & -letters)
    if len(groups) << len(past.registers) > MOST_LETTERS:
        return None
    firsts = [letters & -letters for letters in groups]
    holds = {
        part: sum([1 << place for place, first in enumerate(firsts) if first & letters])
        for part, letters in (true_in | propositions).items()
    }
    rest = _with_parts(past.present, {atom: part for part, atom in parts.items()})
    return Skeleton(past.present, rest, past.registers, tuple(groups), holds)


def _with_parts(outline: Formula, parts: Mapping[Atom, Formula]) -> Formula:
    """An outline with its parts in place of their atoms."""
    if isinstance(outline, Unary | Binary):
        return with_operands(outline, lambda operand: _with_parts(operand, parts))
    return parts.get(outline, outline) if isinstance(outline, Atom) else outline


def _letters_of(
    parts: Mapping[Formula, Atom], propositions: Mapping[Proposition, int], every: int
) -> dict[Proposition, int]:
    """The letters in which each part of an outline is true, from those of its propositions."""
    of_letters = bit_sets(propositions, every)
    return {atom: fold(part, of_letters) for part, atom in parts.items()}


def _split(groups: Iterable[int], sets: Iterable[int]) -> list[int]:
    """The groups, as bits, split by sets."""
    apart = list(groups)
    for members in sets:
        halves = [half for group in apart for half in (group & members, group & ~members)]
        apart = [half for half in halves if half]
    return apart


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


@dataclass(frozen=True, slots=True)
class _Claim:
    """A machine that is to judge words as a formula does; ``true_in`` has its atoms' letters."""

    machine: MealyMonitor
    formula: Formula
    true_in: Mapping[Proposition, int]
    semantics: Semantics


def _is_right(claim: _Claim, translated: Translated, agree: Callable[[], bool]) -> bool:
    """Whether a machine judges words as its formula does.

    This is proved for all words. If the proof takes too long, the compiler compares its automaton
    with the formula as far as it can; unless that is complete, it has to ``agree`` on random words.
    Raises CheckError as ``translated.compare``.
    """
    try:
        _prove(claim)
    except RecursionError:
        pass
    except UnprovableError as problem:
        if problem.word:
            return False
    else:
        return True
    if translated.compare is not None:
        translated.compare()
    return translated.is_checked or agree()


def _prove(claim: _Claim) -> None:
    """Raise UnprovableError unless a machine judges all words as its formula does."""
    machine = claim.machine
    # Letters that neither the formula nor the table tells apart count as one: these are few.
    groups = [
        (number, group)
        for number, letters in enumerate(_classes_of(machine.letters))
        for group in _split([letters], claim.true_in.values())
    ]
    places: dict[Formula, int] = {
        atom: sum([1 << place for place, (_, members) in enumerate(groups) if members & letters])
        for atom, letters in claim.true_in.items()
    }
    prove_words(
        to_data(claim.formula),
        lambda atom: places[from_data(atom)],
        {
            "letters": [number for number, _ in groups],
            "following": machine.successors,
            "accepting": machine.outputs,
            "dead": machine.rejecting_sink,
            "safe": machine.accepting_sink,
        },
        ends=claim.semantics == "finite",
    )


def _classes_of(letters: Sequence[int]) -> list[int]:
    """The letters of each class, as bits."""
    rows = [bytearray(len(letters) // 8 + 1) for _ in range(max(letters) + 1)]
    for letter, number in enumerate(letters):
        if number != IMPOSSIBLE:
            rows[number][letter // 8] |= 1 << letter % 8
    return [int.from_bytes(row, "little") for row in rows]
