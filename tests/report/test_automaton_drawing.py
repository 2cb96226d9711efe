"""Pictures of automata: nothing lies on anything else, and the file is what browsers read."""

import re
from itertools import combinations
from xml.etree import ElementTree

from hypothesis import given

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.logic.formula import Binary, BinaryOperator, Unary, UnaryOperator
from rulec.report.automata.automaton_layout import (
    LINE,
    MOST_STATES,
    STATE_HEIGHT,
    draw,
    is_too_large,
)
from rulec.report.automata.automaton_model import Automaton, Transition, as_dot, automaton_of
from rulec.report.automata.automaton_picture import as_picture
from rulec.report.pictures.drawing.canvas import text_width
from rulec.report.pictures.drawing.picture_formats import as_svg
from support.builders.rulebooks import P, Q, book, compile_here, rule
from support.generators.random_machines import VOCABULARY, machines


def box_of(state):
    (x, y), height = state.middle, STATE_HEIGHT + LINE * (len(state.text) - 1)
    return (x - state.width / 2, y - height / 2, x + state.width / 2, y + height / 2)


def box_of_text(line):
    (x, y), width = line.label_at, text_width(line.text)
    left = x - width if line.leftward else x
    half = LINE * len(line.text) / 2
    return (left, y - half, left + width, y + half)


def overlap(one, other):
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def points_along(line):
    """Points on the curves and straight pieces that the picture draws."""
    for (x, y), (to_x, to_y) in zip(line.points, line.points[1:], strict=False):
        half = (y + to_y) / 2
        for step in range(1, 20):
            t = step / 20
            a, b, c, d = (1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3
            yield a * x + b * x + c * to_x + d * to_x, a * y + b * half + c * half + d * to_y


def inside(point, box):
    """Rounding aside: lines begin and end on the states' borders."""
    near = 1e-6
    across = box[0] + near < point[0] < box[2] - near
    return across and box[1] + near < point[1] < box[3] - near


def check(automaton):
    drawing = draw(automaton)
    states = [box_of(state) for state in drawing.states]
    texts = [box_of_text(line) for line in drawing.lines]
    for one, other in combinations([*states, *texts], 2):
        assert not overlap(one, other)
    for left, top, right, bottom in (*states, *texts):
        assert left >= 0
        assert top >= 0
        assert right <= drawing.width + 1e-6
        assert bottom <= drawing.height
    for line in drawing.lines:
        if line.transition.source != line.transition.target:
            for point in points_along(line):
                assert not any(inside(point, box) for box in (*states, *texts))


@given(machines())
def test_nothing_lies_on_anything_else(machine):
    compiled = CompiledRule("r", "hard", (), "", "", P, machine, "")
    check(automaton_of(compiled, VOCABULARY))


def delayed(steps):
    formula = Q
    for _ in range(steps):
        formula = Unary(UnaryOperator.NEXT, formula)
    formula = Unary(UnaryOperator.ALWAYS, Binary(BinaryOperator.IMPLIES, P, formula))
    rulebook = book(rule("r", formula))
    return automaton_of(compile_here(rulebook).rules[0], rulebook.vocabulary)


def test_seventeen_states():
    automaton = delayed(4)
    assert len(automaton.fates) == 17
    assert not is_too_large(automaton)
    check(automaton)


def test_too_large():
    assert is_too_large(delayed(6))
    chain = tuple(Transition(n, n + 1, "p", False, True) for n in range(MOST_STATES))
    assert is_too_large(Automaton(("open",) * (MOST_STATES + 1), chain))


def test_the_picture_has_every_state_and_condition():
    automaton = delayed(2)
    picture = ElementTree.fromstring(as_svg(as_picture(automaton, "a < b")))
    space = "{http://www.w3.org/2000/svg}"
    words = {text.text for text in picture.iter(f"{space}text")}
    assert {"a < b", "violated for good", "otherwise"} <= words
    assert {str(state) for state in range(len(automaton.fates))} <= words
    lines = list(picture.iter(f"{space}polyline"))
    conditions = [tip.text for line in lines for tip in line]
    assert sorted(conditions) == sorted(one.condition for one in automaton.transitions)
    dashed = [line for line in lines if line.get("class") == "rejected"]
    rejecting = [one for one in automaton.transitions if not one.accepted]
    assert len(dashed) == len(rejecting) + 1  # in the legend


def test_the_source_for_graphviz():
    automaton = delayed(2)
    text = as_dot(automaton, 'a "b" \\ c')
    assert 'digraph "a \\"b\\" \\\\ c" {' in text
    edges = re.findall(r'^  (\d+) -> (\d+) \[label="([^"]*)"(, style=dashed)?', text, re.MULTILINE)
    assert [(int(a), int(b), bool(dashed)) for a, b, _, dashed in edges] == [
        (one.source, one.target, not one.accepted) for one in automaton.transitions
    ]
    assert text.count("{") == text.count("}") == 1
    assert 'label="4\\nviolated\\nfor good"' in text
