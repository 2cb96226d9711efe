"""Several steps in one look-up: the verdicts are those of a machine that reads letter by letter."""

from random import Random

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from rulec.monitoring.batch.machines.joint_machine import JointMachine
from rulec.monitoring.batch.machines.table_run import (
    _lengths,
    run,
    run_multi_step,
    steps_of,
)
from rulec.trace.trace_columns import layout_of, smallest_unsigned


def walked(following, verdicts, words):
    found = []
    for word in words:
        state = 0
        for letter in word[:-1]:
            state = following[state][letter]
        found.append(verdicts[state][word[-1]])
    return found


def random_machine(chance, n_states, n_letters):
    following = [[chance.randrange(n_states) for _ in range(n_letters)] for _ in range(n_states)]
    verdicts = [[chance.randrange(256) for _ in range(n_letters)] for _ in range(n_states)]
    return tuple(map(tuple, following)), tuple(map(tuple, verdicts))


def column_of(words, layout, dtype):
    column = [word[step] for step in range(layout.n_steps) for word in words if step < len(word)]
    return np.array(column, dtype=dtype)


def words_of(chance, n_traces, n_letters, longest, n_lengths):
    lengths = [chance.randint(1, longest) for _ in range(n_lengths)]
    found = [chance.choices(range(n_letters), k=chance.choice(lengths)) for _ in range(n_traces)]
    return sorted(found, key=len, reverse=True)


@given(
    st.integers(1, 12),
    st.integers(1, 9),
    st.integers(1, 900),
    st.integers(1, 12),
    st.integers(1, 3),
    st.randoms(use_true_random=False),
)
@example(1, 1, 4, 12, 1, Random(0))
def test_verdicts_are_those_of_the_words(n_states, n_letters, n_traces, longest, n_lengths, chance):
    following, verdicts = random_machine(chance, n_states, n_letters)
    words = words_of(chance, n_traces, n_letters, longest, n_lengths)
    layout = layout_of(list(map(len, words)))
    letters = column_of(words, layout, np.uint8)
    found = run_multi_step(following, verdicts, letters, steps_of(layout, 0, None))
    assert found.tolist() == walked(following, verdicts, words)


@given(st.integers(1, 40), st.integers(1, 9), st.integers(1, 9))
def test_steps_are_parted_into_few_leaps(n_steps, first, later):
    first = max(first, later)
    found = list(_lengths(n_steps, first, later))
    assert sum(found) == n_steps
    assert 1 <= found[0] <= first
    assert all(1 <= length <= later for length in found[1:])
    assert n_steps > first + later * (len(found) - 2) or len(found) == 1


@pytest.mark.parametrize("n_cells", [3, 16, 17, 250, 300, 60_000])
@pytest.mark.parametrize("n_states", [1, 15, 16, 60, 300])
def test_every_way_to_run_gives_the_same(n_cells, n_states):
    """Cells or letters, bytes or more, in leaps or not: by the sizes of the machine."""
    chance = Random(n_cells * 1000 + n_states)
    n_letters = min(n_cells, 7)
    following, verdicts = random_machine(chance, n_states, n_letters)
    meant = tuple(chance.choices(range(n_letters), k=n_cells))
    joint = JointMachine((0,), meant, following, verdicts)
    words = words_of(chance, 1200, n_cells, 8, 8)
    layout = layout_of(list(map(len, words)))
    cells = column_of(words, layout, smallest_unsigned(n_cells))
    spelled = [[meant[cell] for cell in word] for word in words]
    assert run(joint, cells, layout).tolist() == walked(following, verdicts, spelled)
    shortest = len(words[-1])
    first, last = min(1, shortest - 1), shortest - 1
    parts = [word[first : last + 1] for word in spelled]
    assert run(joint, cells, layout, first, last).tolist() == walked(following, verdicts, parts)
