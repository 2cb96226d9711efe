"""Rulebooks that no one would write are answered soon, with a message or two, and no traceback."""

from pathlib import Path

import pytest

from rulec.diagnostics import RulecError
from rulec.resource_limits import in_force
from rulec.rulebook.files.referenced_files import MOST_BASES
from rulec.rulebook.loader import diagnose
from rulec.rulebook.names.atom_messages import MOST_SEARCHED
from rulec.rulebook.reading.rulebook_reader import load_rulebook

START = """rulebook r
type car
signal p, q, a, b, c, d default false
signal near(o: car) default false
quantity speed in km/h default 0
quantity gap in mm default 0
"""


def chain(first, link, number):
    """`first`, and then `link` with each number filled in."""
    links = [link.format(here=at + 1, before=at) for at in range(number)]
    return "\n".join([first, *links])


def rule(require, rest=""):
    return f"\nhard rule r {{ require {require} {rest} }}\n"


DOUBLING = chain("define d0 = p", "define d{here} = d{before} and d{before}", 40)
NESTED = chain("define d0 = p", "define d{here} = not d{before}", 2000)
SQUARES = chain("param n0 = 10", "param n{here} = n{before} * n{before}", 60)
SUMS = chain("param n0 = speed", "param n{here} = n{before} + n{before}", 60)
CASES = chain("param n0 = 1 m", "param n{here} = 1 m if gap < n{before} else 2 m", 60)
CHOICES = chain("define d0 = p", "define d{here} = (q if d{before} else p)", 60)
COUNTS = chain(
    "define d0(v: car) = near(v)",
    "define d{here}(v: car) = some x: car (x != v and d{before}(x))",
    300,
)
SUMMED = chain("param n0 = 1 m", "param n{here} = n{before} + 1 m", 3000)
BACKWARDS = "\n".join(reversed(SUMMED.splitlines()))
THROUGHOUT = "unless a unless b unless c unless d"

HOSTILE = {
    "definitions that double each other": (DOUBLING + rule("d40"), {"R0323"}),
    "definitions inside one another": (NESTED + rule("d2000"), {"R0111"}),
    "squares of squares": (SQUARES + rule("gap < n60 * 1 m"), {"R0323"}),
    "sums of sums": (SUMS + rule("speed < n60"), {"R0323"}),
    "cases of cases": (CASES + rule("gap < n60"), {"R0323"}),
    "choices of choices": (CHOICES + rule("d60"), {"R0323"}),
    "counts in counts": (COUNTS + "hard rule r (v: car) { require always d300(v) }", {"R0111"}),
    "many exceptions and phases": (
        rule(f"never ({'p then q then ' * 40} p)", THROUGHOUT),
        {"R0111"},
    ),
    "thousands of exceptions": (rule("never p", "unless q at start " * 3000), {"R0111"}),
    "a million digits": (rule(f"gap < {'1' * 1_000_000} m"), {"R0112"}),
    "a million places": (rule(f"gap < 0.{'1' * 1_000_000} m"), {"R0112"}),
    "too large": (rule("gap < 1e400 m"), {"R0112"}),
    "far too large": (rule("gap < 1e999999999 m"), {"R0112"}),
    "far too small": (rule("gap < 1e-999999999 m"), {"R0112"}),
    "nothing, far too small": (rule("gap < 0e999999999 m"), {"R0112"}),
    "steps": (rule("next[1e999999999 steps] p"), {"R0112"}),
    "a weight": ("\nsoft rule r weight 1e-999999999 { require always p }", {"R0112"}),
    "a value that overflows in its unit": (
        rule("gap < 1 m", "accept { gap = 1e308 km }"),
        {"R0112"},
    ),
    "thousands of unknown names": (
        "\n".join(f"param n{at} = what{at} + 1 m" for at in range(3000)) + rule("gap < n3"),
        {"R0202"},
    ),
    "parameters made of each other": (
        "param m = n if gap < 1 m else 1 m\nparam n = m if gap < 2 m else 2 m" + rule("gap < m"),
        {"R0316"},
    ),
}


def errors_of(text):
    found = diagnose("hostile.rules", text.encode()).findings
    return [one for one in found if one.severity == "error"]


@pytest.mark.parametrize("name", HOSTILE)
def test_what_no_one_would_write(name):
    text, codes = HOSTILE[name]
    errors = errors_of(START + text)
    assert {one.code for one in errors} == codes
    assert all(one.place.line is not None for one in errors)
    if codes != {"R0202"}:
        # One cause, few messages.
        assert len(errors) < 20


def test_only_for_the_first_unknown_names_similar_ones_are_looked_for():
    """With thousands it would take longer than anybody waits, and nobody reads so many."""
    lines = [f"hard rule r{at} {{ require always speeed{at} < 1 km/h }}" for at in range(130)]
    found = errors_of(
        START + "\n".join([*lines, "hard rule l { require always speeed0 < 1 km/h }"])
    )
    helps = [str(one.help) for one in found]
    assert len(helps) == 131
    are_searched = ["did you mean `speed`" in text for text in helps]
    assert are_searched == [True] * MOST_SEARCHED + [False] * 30 + [True]
    assert all(
        "declare it" in text for text, done in zip(helps, are_searched, strict=True) if not done
    )


def test_types_in_a_chain_that_is_too_long_are_cut_where_it_is():
    text = START + chain("type t0", "type t{here} is t{before}", 1000) + rule("p")
    errors = errors_of(text)
    assert {one.code for one in errors} == {"R0718"}
    cut = [one.message.split("`")[1] for one in errors]
    assert cut == [f"t{at}" for at in range(100, 1001, 100)]
    with in_force(["type_depth=1001"]):
        assert errors_of(text) == []


@pytest.mark.parametrize(
    "text",
    [
        chain("param n0 = 1 m", "param n{here} = 2 m", 5000) + rule("gap < n77"),
        SUMMED + rule("gap < n3000"),
        BACKWARDS + rule("gap < n3000"),
        chain("define d0 = p", "define d{here} = not d{before}", 100) + rule("d100"),
        "\n".join(f"hard rule r{at} {{ require always p }}" for at in range(2000)),
    ],
    ids=["many parameters", "a long sum", "a long sum, backwards", "definitions", "rules"],
)
def test_what_is_long_but_right(text):
    assert errors_of(START + text) == []


def write_chain(folder, number):
    """Rulebooks of which each extends the one before; the path of the last one."""
    (folder / "b0.rules").write_text("rulebook b0 signal p hard rule r { require always p }")
    for at in range(1, number):
        text = f'rulebook b{at} extends b{at - 1} override rule r {{ says "{at}" }}'
        (folder / f"b{at}.rules").write_text(text)
    return folder / f"b{number - 1}.rules"


def test_a_long_chain_of_rulebooks(tmp_path):
    (rule,) = load_rulebook(write_chain(tmp_path, MOST_BASES + 1)).rules
    assert rule.says == str(MOST_BASES)


def test_too_long_a_chain_of_rulebooks(tmp_path):
    with pytest.raises(RulecError, match="R0327"):
        load_rulebook(write_chain(tmp_path, MOST_BASES + 2))
    path = write_chain(tmp_path, 200)
    with pytest.raises(RulecError) as caught:
        load_rulebook(path)
    (one,) = caught.value.diagnostics
    assert (one.code, f"{MOST_BASES} rulebooks" in one.message) == ("R0327", True)
    # Where its author can do something about it, and where the fifty are used up.
    assert Path(one.place.file).name == "b199.rules"
    (last,) = one.labels
    assert Path(last.place.file).name == f"b{199 - MOST_BASES}.rules"


def test_too_many_levels():
    levels = " > ".join(f"l{at}" for at in range(5000))
    (one,) = errors_of(f"rulebook r priority {levels} signal p {rule('p')}")
    assert one.code == "R0327"
