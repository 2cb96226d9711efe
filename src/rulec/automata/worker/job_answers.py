"""The answer to a job: a machine that was compared with its formula, or why there is none."""

from __future__ import annotations

import random
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import repeat

from rulec.automata.alphabet import count_letters, letters_with, propositions_of
from rulec.automata.axiom_groups import AxiomGroup
from rulec.automata.clocks.clocked_machine import ClockedMachine, ClockLetters, TimedMachine
from rulec.automata.compiler_jobs import (
    MOST_LETTERS,
    MOST_OPERATORS,
    AcceptanceError,
    BeyondReachError,
    CheckError,
    Compiler,
    Done,
    Failed,
    Job,
    Translated,
)
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read
from rulec.automata.tables import SizeError, build_machine, rows_of
from rulec.logic.bounds import BOOLEAN, bound_in_steps, in_steps, operations_of, range_of
from rulec.logic.codec import from_data, to_data
from rulec.logic.fold import bit_sets, fold
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Constant,
    Formula,
    Proposition,
    Unary,
    atoms_of,
    with_operands,
)
from rulec.logic.past_registers import without_clocks
from rulec.logic.semantics import Semantics, holds, truth_values
from rulec.rulebook.rules.axiom_instances import AxiomInstance
from rulec.validation.table_proof import prove_words
from rulec.validation.unprovable import UnprovableError


def answer_to(job: Job, compiler: Compiler) -> Done | ClockedMachine | Failed:
    """The machine of a job, beside the clocks that it has, or the reason why there is none."""
    if count_letters(job.reads) > job.most_letters:
        return Failed("letters")
    if _written_out(job.formula) > MOST_OPERATORS:
        return Failed("size")
    for group in job.groups:
        if compiler.contradicts(group.known):
            return Failed("facts", contradiction=_contradiction(group, compiler))
    try:
        return _whole(job, compiler) if job.clocks is None else _apart(job, compiler)
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
    timed, parts = outlined(job.formula)
    propositions = letters_with(job.reads, job.propositions)
    claim = _Claim(machine, timed, _letters_of(parts, propositions, every), job.semantics)
    if not _is_right(claim, translated, lambda: agrees(machine, job.formula, job.semantics)):
        raise CheckError
    return Done(machine, translated.hoa)


def _apart(job: Job, compiler: Compiler) -> ClockedMachine | Failed:
    """The answer by translating what remains of a formula once its past is in clocks."""
    asked = job.clocks or ()
    if compiler.rest is None:
        return Failed("apart")
    parts: dict[Formula, Atom] = {}
    atoms = frozenset([own.atom for own in asked])
    present = outline(job.formula, parts, atoms)
    sides = [(outline(own.left, parts, atoms), outline(own.right, parts, atoms)) for own in asked]
    every, possible = (1 << count_letters(job.reads)) - 1, compiler.possible(job)
    propositions = letters_with(job.reads, job.propositions)
    true_in = _letters_of(parts, propositions, every)
    groups, firsts = _groups(true_in.values(), every if possible is None else possible, job.reads)
    n_groups, n_values = len(firsts), 1 << len(asked)
    n_letters = n_groups * n_values
    if n_letters > MOST_LETTERS:
        return Failed("apart")
    # A letter of the table is a group and a value of each clock, as bits.
    held_in: dict[Proposition, tuple[int, Sequence[int]]] = {}
    for part, own in (true_in | propositions).items():
        row = _row(own, len(groups))
        held_in[part] = _bits([row[first] for first in firsts]), range(n_values)
    for place, clock in enumerate(asked):
        held = [values for values in range(n_values) if values >> place & 1]
        held_in[clock.atom] = (1 << n_groups) - 1, held
    letters = {
        part: sum([own << n_groups * values for values in each])
        for part, (own, each) in held_in.items()
    }
    algebra = bit_sets(letters, (1 << n_letters) - 1)
    clocks = ClockLetters(
        n_groups,
        tuple(
            [_codes(fold(left, algebra), fold(right, algebra), n_letters) for left, right in sides]
        ),
    )
    met = clocks.possible([clock.bound for clock in asked])
    translated = compiler.rest(job, job.formula, letters, n_letters)
    rows = rows_of(translated.automaton, sum([1 << letter for letter in met]))
    table = build_machine(rows, (), n_letters)
    machine = ClockedMachine(job.reads, groups, clocks, table, translated.hoa)
    claim = _Claim(table, present, letters, job.semantics)

    def agree() -> bool:
        # With any bounds, such as these for what begins at the present instant or later
        bounds = tuple([bound_in_steps(clock.bound, Fraction(2)) for clock in asked])
        unrolled = TimedMachine(machine, bounds, ends=job.semantics == "finite").at(None)
        whole = in_steps(without_clocks(job.formula, asked), Fraction(2))
        return agrees(unrolled, whole, job.semantics)

    if not _is_right(claim, translated, agree):
        raise CheckError
    return machine


def _row(members: int, n_letters: int) -> str:
    """A set of letters, given as bits, with a 1 or a 0 for each: bit by bit it takes far longer."""
    return f"{members:0{n_letters}b}"[::-1]


def _bits(row: Sequence[str]) -> int:
    return int("".join(reversed(row)), 2)


def _codes(left: int, right: int, n_letters: int) -> tuple[int, ...]:
    """For each letter 1 if it is among the first ones, plus 2 if among the others, as bits."""
    rows = zip(_row(left, n_letters), _row(right, n_letters), strict=True)
    return tuple([int(one) + 2 * int(other) for one, other in rows])


def _groups(
    sets: Iterable[int], possible: int, reads: Sequence[Read | NumberRead]
) -> tuple[tuple[int, ...], list[int]]:
    """For each letter the number of those that no set tells from it, and the first of each number.

    ``IMPOSSIBLE`` for those that are not ``possible``.
    """
    n_letters = count_letters(reads)
    numbers: dict[tuple[str, ...], int] = {}
    groups, firsts = [IMPOSSIBLE] * n_letters, list[int]()
    keys = zip(*[_row(members, n_letters) for members in (possible, *sets)], strict=True)
    for letter, key in enumerate(keys):
        if key[0] == "1":
            groups[letter] = numbers.setdefault(key, len(numbers))
            if groups[letter] == len(firsts):
                firsts.append(letter)
    return tuple(groups), firsts


def _letters_of(
    parts: Mapping[Formula, Atom], propositions: Mapping[Proposition, int], every: int
) -> dict[Proposition, int]:
    """The letters in which each part of an outline is true, from those of its propositions."""
    of_letters = bit_sets(propositions, every)
    return {atom: fold(part, of_letters) for part, atom in parts.items()}


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
    rows = [_row(letters, len(machine.letters)) for letters in claim.true_in.values()]
    groups = [
        key
        for key in dict.fromkeys(zip(machine.letters, *rows, strict=True))
        if key[0] != IMPOSSIBLE
    ]
    columns = list(zip(*groups, strict=True))
    places: dict[Formula, int] = {
        atom: _bits(column) for atom, column in zip(claim.true_in, columns[1:], strict=True)
    }
    prove_words(
        to_data(claim.formula),
        lambda atom: places[from_data(atom)],
        {
            "letters": columns[0],
            "following": machine.successors,
            "accepting": machine.outputs,
            "dead": machine.rejecting_sink,
            "safe": machine.accepting_sink,
        },
        ends=claim.semantics == "finite",
    )


MOST_WORDS, FEWEST_WORDS = 300, 40
_EFFORT = 200_000
"""The approximate number of values evaluated in all, unless the fewest words need more."""


def agrees(machine: MealyMonitor, formula: Formula, semantics: Semantics) -> bool:
    """Whether a monitor agrees with the semantics on pseudo-random possible words.

    Some letters are repeated about as often as a bound of the formula, where bounds matter.
    """
    chance = random.Random(0)
    possible = [n for n, symbol in enumerate(machine.letters) if symbol != IMPOSSIBLE]
    sets = letters_with(machine.reads, propositions_of(formula))
    bounds = _bounds(formula)
    size = 1 + sum(1 for _ in operations_of(formula))
    affordable = _EFFORT // (size * (8 + max(bounds, default=0)))
    n_words = max(FEWEST_WORDS, min(MOST_WORDS, affordable))
    words = [list(_word(chance, possible, bounds)) for _ in range(n_words)]
    letters = {
        number: frozenset([each for each, true_in in sets.items() if true_in >> number & 1])
        for number in {number for word in words for number in word}
    }
    timed, parts = outlined(formula)
    phases: dict[int, set[Atom]] = {number: set() for number in letters}
    for part, atom in parts.items():
        values = truth_values(part, list(letters.values()))
        for true, value in zip(phases.values(), values, strict=True):
            true.update([atom] if value else [])
    return all(
        verdict(machine, word)
        == holds(timed, [frozenset(phases[number]) for number in word], semantics)
        for word in words
    )


def outlined(formula: Formula) -> tuple[Formula, Mapping[Formula, Atom]]:
    """The formula with each part about the present state alone replaced by an atom, and these."""
    parts: dict[Formula, Atom] = {}
    return outline(formula, parts), parts


def outline(
    formula: Formula, parts: dict[Formula, Atom], apart: Container[Formula] = ()
) -> Formula:
    """The formula with each part about the present state alone replaced by its atom in ``parts``.

    New ones are added there. Atoms kept ``apart`` stay, and are in no part.
    """

    def written(part: Formula) -> Formula:
        if isinstance(part, Constant) or part in apart:
            return part
        if isinstance(part, Unary | Binary) and not _is_plain(part, apart):
            return with_operands(part, written)
        return parts.setdefault(part, Atom(f"part {len(parts)}"))

    return written(formula)


def _is_plain(formula: Formula, apart: Container[Formula]) -> bool:
    is_timed = any(operation.operator not in BOOLEAN for operation in operations_of(formula))
    return not is_timed and not any(atom in apart for atom in atoms_of(formula))


def _bounds(formula: Formula) -> list[int]:
    """The bounds of a formula in steps, and the numbers next to them."""
    ranges = {range_of(operation) for operation in operations_of(formula)}
    numbers = {number for limits in ranges for number in limits if number is not None}
    return sorted({near for number in numbers for near in range(number - 1, number + 3)} - {-1, 0})


def _word(chance: random.Random, letters: list[int], bounds: list[int]) -> Iterator[int]:
    # With only a few letters, repetitions are more likely than with all of them.
    some = [letters[chance.randrange(len(letters))] for _ in range(chance.randint(1, 4))]
    for _ in range(chance.randint(1, 8)):
        number = chance.choice(some)
        times = chance.choice(bounds) if bounds and chance.random() < 0.5 else 1
        yield from repeat(number, times)


def verdict(machine: MealyMonitor, numbers: list[int]) -> bool:
    """The machine's verdict on a word of letters, given by their numbers."""
    state, accepted = 0, False
    for number in numbers:
        symbol = machine.letters[number]
        accepted = machine.outputs[state][symbol]
        state = machine.successors[state][symbol]
    return accepted
