"""Words find places of their own, inside a room that is large enough."""

from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from rulec.report.pictures.drawing.canvas import LabelText, Placing

lengths = st.integers(0, 120)
rooms = st.builds(
    lambda x, y, width, height: (float(x), float(y), float(x + width), float(y + height)),
    lengths,
    lengths,
    st.integers(1, 80),
    st.integers(1, 80),
)


@given(st.lists(st.tuples(st.text("abc", min_size=1, max_size=6), st.lists(rooms, min_size=1))))
def test_inside_and_apart(wanted):
    placing = Placing()
    found = []
    for text, choices in wanted:
        words = placing.place([text, "1"], choices)
        if words is not None:
            assert words.text in (text, "1")
            left, top, right, bottom = words.bounds
            assert any(
                room[0] <= left
                and room[1] <= top + 1e-9
                and right <= room[2]
                and bottom <= room[3] + 1e-9
                for room in choices
            )
            found.append(words.bounds)
    for one, other in combinations(found, 2):
        assert one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


def test_the_first_text_that_fits_upright_if_it_can_be():
    assert Placing().place(["abc", "1"], [(0, 0, 100, 100)]) == LabelText("abc", (50, 50), "middle")
    turned = Placing().place(["abc", "1"], [(0, 0, 25, 100)])
    assert (turned.text, turned.turned) == ("abc", True)
    assert Placing().place(["abc", "1"], [(0, 0, 25, 20)]).text == "1"
    assert Placing().place(["abc", "1"], [(0, 0, 5, 5)]) is None


def test_of_large_rooms_the_middle_one():
    lanes = [(0, 50 * n, 100, 50 * n + 46) for n in range(5)]
    words = Placing().place(["a"], lanes)
    assert words.at == (50, 100 + 23)
    # A lane that is much longer is better than the middle.
    assert Placing().place(["a"], [*lanes, (0, 250, 400, 296)]).at == (200, 250 + 23)


def test_what_is_taken_is_left_alone():
    placing = Placing([(30, 0, 70, 20)])
    words = placing.place(["a"], [(0, 0, 100, 20)])
    assert words.bounds[2] <= 30 or words.bounds[0] >= 70
    assert placing.first_free([words, LabelText("b", (150, 10))]) == [LabelText("b", (150, 10))]
