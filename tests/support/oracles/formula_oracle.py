"""What formulas mean on a word, written down again from the documentation.

It shares no code with ``rulec.logic.semantics`` and is what that and all engines are compared with.
"""

from fractions import Fraction
from functools import cache

from rulec.logic.formula import Binary, Bound, Constant, Unary


def by_definition(formula, word, semantics):
    """The formula's value at each instant, word for word from the definitions, with no thrift."""
    at = values(formula, word, semantics)
    return [at(formula, instant) for instant in range(len(word))]


def is_kept(formula, word, semantics):
    """The formula's value at the first instant."""
    return values(formula, word, semantics)(formula, 0)


def values(formula, word, semantics):
    """The function that says of any part of the formula whether it holds at an instant.

    Later than this nothing changes any more: the word's length, and all bounds beyond it.
    """
    finite = semantics == "finite"
    last = len(word) - 1
    n_instants = len(word) if finite else len(word) + total(formula) + 1

    def ahead(bound, now, least=0):
        """The distances ahead within the bound at which there is an instant to look at."""
        low = max(int(bound.low) if bound else 0, least)
        high = int(bound.high) if bound and bound.high is not None else None
        if high is None:
            high = max(low, n_instants - now)
        return [k for k in range(low, high + 1) if not finite or now + k <= last]

    def back(bound, now):
        low = int(bound.low) if bound else 0
        high = int(bound.high) if bound and bound.high is not None else now
        return range(low, min(high, now) + 1)

    @cache
    def at(part, now):
        match part:
            case Constant(value):
                return value
            case Unary(operator, p, bound):
                n = int(bound.low) if bound else 1
                exists = not finite or now + n <= last
                return {
                    "not": lambda: not at(p, now),
                    "next": lambda: exists and at(p, now + n),
                    "weak next": lambda: not exists or at(p, now + n),
                    "eventually": lambda: any(at(p, now + k) for k in ahead(bound, now)),
                    "always": lambda: all(at(p, now + k) for k in ahead(bound, now)),
                    "never": lambda: not any(at(p, now + k) for k in ahead(bound, now)),
                    "previously": lambda: now >= n and at(p, now - n),
                    "weak previously": lambda: now < n or at(p, now - n),
                    "once": lambda: any(at(p, now - k) for k in back(bound, now)),
                    "historically": lambda: all(at(p, now - k) for k in back(bound, now)),
                }[operator.value]()
            case Binary(operator, p, q, bound):

                def until(one, other, least=0):
                    return any(
                        other(now + k) and all(one(now + j) for j in range(k))
                        for k in ahead(bound, now, least)
                    )

                def weak_until(one, other):
                    whole = Bound(Fraction(0), bound.high, "steps") if bound else None
                    return until(one, other) or all(one(now + k) for k in ahead(whole, now))

                def yes(part):
                    return lambda instant: at(part, instant)

                def no(part):
                    return lambda instant: not at(part, instant)

                return {
                    "and": lambda: at(p, now) and at(q, now),
                    "or": lambda: at(p, now) or at(q, now),
                    "implies": lambda: not at(p, now) or at(q, now),
                    "iff": lambda: at(p, now) is at(q, now),
                    "xor": lambda: at(p, now) is not at(q, now),
                    "until": lambda: until(yes(p), yes(q)),
                    "then": lambda: until(yes(p), yes(q), least=1),
                    "weak until": lambda: weak_until(yes(p), yes(q)),
                    "release": lambda: not until(no(p), no(q)),
                    "strong release": lambda: not weak_until(no(p), no(q)),
                    "since": lambda: any(
                        at(q, now - k) and all(at(p, now - j) for j in range(k))
                        for k in back(bound, now)
                    ),
                }[operator.value]()
            case _:
                return part in word[min(now, last)]

    return at


def total(formula):
    match formula:
        case Unary(_, operand, bound):
            return extent(bound) + total(operand)
        case Binary(_, left, right, bound):
            return extent(bound) + total(left) + total(right)
    return 0


def extent(bound):
    if bound is None:
        return 1
    return int(bound.low if bound.high is None else bound.high) + 1
