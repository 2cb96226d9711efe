"""Coordinates that mean the same place become one, and only those."""

from hypothesis import given
from hypothesis import strategies as st

from rulec.partition.cells.roadway import EPSILON_M, snap_table

NEAR = 0.9 * EPSILON_M


def test_the_roads_own_coordinate_stands_for_what_is_near():
    table = snap_table([2.0], [2.0 - NEAR, 5.0])
    assert table == {2.0: 2.0, 2.0 - NEAR: 2.0, 5.0: 5.0}


def test_of_moving_ones_the_smallest_stands_for_the_others():
    assert snap_table([], [1.0 + NEAR, 1.0]) == {1.0: 1.0, 1.0 + NEAR: 1.0}


def test_a_chain_of_near_places_does_not_collapse():
    chain = [10 + n * NEAR for n in range(5)]
    table = snap_table([], chain)
    # In pairs: each group reaches no further than EPSILON_M from its first.
    assert [table[value] for value in chain] == [chain[0], chain[0], chain[2], chain[2], chain[4]]


@given(st.lists(st.floats(-100, 100)), st.lists(st.floats(-100, 100)))
def test_nothing_moves_further_than_epsilon_and_order_is_kept(fixed, moving):
    table = snap_table(fixed, moving)
    assert table.keys() == {*fixed, *moving}
    assert all(abs(value - table[value]) <= EPSILON_M for value in table)
    ranked = [table[value] for value in sorted(table)]
    assert ranked == sorted(ranked)
    assert all(table[value] == value for value in table.values())
