"""Limits on the cost of a question that its input's size does not bound; ``docs/limits.md``.

Code that is about to use time or memory growing with a value calls ``within`` first. The limits in
force are those of the environment variable ``RULEC_LIMITS``, which worker processes inherit;
``rulec --limit`` sets it.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Final

from rulec.diagnostics import RulecError, SourceLocation, did_you_mean, named
from rulec.diagnostics.code import Code
from rulec.resources import variable_set

OVER_LIMIT = Code("R0718")

NO_LIMIT = Code("R0719")

VARIABLE: Final = "RULEC_LIMITS"
"""The environment variable: settings such as ``choices=5000000``, separated by spaces."""

MOST_DIGITS: Final = 1000
"""The most digits of a number read exactly, in rulebooks, compiled files and saved monitors."""


class BudgetSpentError(RulecError):
    """A budget of time for a whole call is spent, so that no part of it is answered any more.

    What has been answered by then depends on the machine: to leave out the rest and go on would
    make the answer depend on it, too.
    """


@dataclass(frozen=True, slots=True)
class ResourceLimit:
    """A limit by name: the greatest number of ``counted``, and what else helps."""

    name: str
    usual: int
    counted: str
    way_out: str

    def value(self) -> int:
        """The limit in force. Raises RulecError R0719 if the environment's setting is invalid."""
        return settings_in(os.environ.get(VARIABLE, "").split()).get(self.name, self.usual)

    def within(self, amount: int, place: SourceLocation | None, whose: str = "") -> None:
        """Raise RulecError R0718 if the amount exceeds the limit.

        Args:
            amount: the actual or expected number.
            place: the input that requires it.
            whose: what it belongs to, such as "rule `gap`".
        """
        if amount > self.value():
            raise self.exceeded(place, whose, f"{amount:,}" if amount < 10**18 else "over 10^18")

    def spent(self, place: SourceLocation | None, whose: str) -> BudgetSpentError:
        """The error for a budget that is spent, which ends the whole call."""
        return BudgetSpentError(self.exceeded(place, whose).diagnostics)

    def exceeded(
        self, place: SourceLocation | None, whose: str = "", amount: str = ""
    ) -> RulecError:
        """The error for an amount (in words, if known) that exceeds the limit in force."""
        amount = amount or f"more than {self.value():,}"
        of = f"{whose}: " if whose else ""
        return OVER_LIMIT.error(
            place,
            f"{of}{amount} {self.counted}, and the limit is {self.value():,}",
            help=f"{self.way_out}; `rulec --limit {self.name}=NUMBER` lifts the limit",
        )


CHOICES: Final = ResourceLimit(
    "choices",
    1_000_000,
    "choices of objects for a rule's variables",
    "give the rule fewer variables or narrower types, or the trace fewer objects",
)
STEPS: Final = ResourceLimit(
    "steps",
    50,
    "steps of traces that its rules would be compiled for, beside the first",
    "bring the traces to one step, with `rulec verify --step` if their clock jitters, or "
    "compile the rulebook for the steps that count, with `rulec compile --step`",
)

OBJECTS: Final = ResourceLimit(
    "objects",
    20_000,
    "objects in one trace",
    "cut the drive into several traces, each with only the objects present in it",
)

PLACES: Final = ResourceLimit(
    "places",
    20_000,
    "obstacles of a scenario, times layers of its graph",
    "take a longer step, a shorter horizon, or obstacles that ego may come near to",
)

COMPILING: Final = ResourceLimit(
    "compiling",
    120,
    "seconds of processor time for the automata of a rulebook",
    "split large rules into several, or use shorter bounds, or longer or fewer steps; a rulebook "
    "that a program compiles anew has this time anew",
)


@dataclass(slots=True)
class CompilerTime:
    """The processor time (s) that compilers have taken for a rulebook, and its limit."""

    most_s: float = field(default_factory=COMPILING.value)
    taken_s: float = 0.0

    @property
    def left_s(self) -> float:
        """How much is left."""
        return self.most_s - self.taken_s


CUBES: Final = ResourceLimit(
    "cubes",
    500,
    "alternatives of one condition in its automaton's picture",
    "`rulec compile` writes it to a file all the same; or split its demands into several rules",
)

PAIRS: Final = ResourceLimit(
    "pairs",
    100_000,
    "pairs of rules that share a word, counted for each word",
    "analyze its parts in rulebooks of their own",
)

COMPARISONS: Final = ResourceLimit(
    "comparisons",
    30_000,
    "pairs of rules of one name in two rulebooks",
    "name fewer rulebooks, or only some rules, with `--rule PATTERN`",
)

TYPE_DEPTH: Final = ResourceLimit(
    "type_depth",
    100,
    "types, each a subtype of the next one",
    "leave out types that no rule distinguishes",
)

SEARCH: Final = ResourceLimit(
    "search",
    2_000_000,
    "steps of search for states of the world, in one question about rules",
    "split the rule into several",
)

STATES: Final = ResourceLimit(
    "states",
    3_000_000,
    "rows or JSON objects for the states of one trace",
    "cut the drive into several traces, or use a longer step",
)

REFUSED: Final = ResourceLimit(
    "refused",
    20_000,
    "traces one after the other that cannot be judged",
    "correct the mistake, which is often the same in all of them",
)

CITES: Final = ResourceLimit(
    "cites",
    100_000_000,
    "characters of articles to look through for what its rules cite",
    "give the text of the law with a heading for each article",
)

LOOKBACK: Final = ResourceLimit(
    "lookback",
    1_000_000,
    "steps to look back, its bounds added up",
    "give it bounds no longer than drives last",
)

CROWD: Final = ResourceLimit(
    "crowd",
    400,
    "others in the same square of 100 m as a participant, on average",
    "look at its places: no road has room for so many; or take a part of the recording",
)

MEMORY: Final = ResourceLimit(
    "memory",
    1 << 30,
    "bytes of memory",
    "give it less at once, such as fewer files, or a part of the recording",
)

SECONDS: Final = ResourceLimit(
    "seconds",
    10**9,
    "seconds of processor time for the whole call",
    "give it less at once, such as fewer files, or a part of the recording",
)

LIMITS: Final = {
    limit.name: limit
    for limit in (
        CHOICES,
        STEPS,
        STATES,
        REFUSED,
        OBJECTS,
        PLACES,
        COMPILING,
        CUBES,
        PAIRS,
        COMPARISONS,
        TYPE_DEPTH,
        SEARCH,
        CITES,
        LOOKBACK,
        CROWD,
        MEMORY,
        SECONDS,
    )
}
"""All limits that can be changed."""


def is_set(limit: ResourceLimit) -> bool:
    """Whether a limit has been set, to whatever number. Raises RulecError R0719."""
    return limit.name in settings_in(os.environ.get(VARIABLE, "").split())


def settings_in(texts: Iterable[str]) -> dict[str, int]:
    """Limits by name from texts such as ``choices=5000000``. Raises RulecError R0719."""
    limits: dict[str, int] = {}
    for text in texts:
        name, _, value = text.partition("=")
        if name not in LIMITS:
            hint = did_you_mean(name, list(LIMITS)) or f"there are {named(list(LIMITS))}"
            raise NO_LIMIT.error(None, f"there is no limit `{name}`", help=hint)
        if _NUMBER.fullmatch(value) is None:
            raise NO_LIMIT.error(
                None,
                f"the limit `{name}` is a whole number, not `{value}`",
                help=f"write it as in `{name}={LIMITS[name].usual}`",
            )
        limits[name] = int(value)
    return limits


_NUMBER = re.compile(r"[0-9]{1,15}")


@contextmanager
def in_force(texts: Iterable[str]) -> Iterator[None]:
    """Set limits, here and in processes started meanwhile, while the block runs.

    Raises RulecError R0719.
    """
    given = {**settings_in(os.environ.get(VARIABLE, "").split()), **settings_in(texts)}
    with variable_set(VARIABLE, " ".join(f"{name}={value}" for name, value in given.items())):
        yield
