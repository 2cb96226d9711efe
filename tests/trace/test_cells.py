"""Some cells of arrays, laid flat."""

import numpy as np

from rulec.trace.cells import Cells
from rulec.trace.end_to_end import EndToEnd

FLAGS = np.array([[0, 1, 0], [0, 0, 0], [1, 0, 1]], dtype=bool)
VALUES = np.array([[1, 2, 3], [4, 5, 6], [7, 8, 9]])


def test_where_they_are():
    cells = Cells.at(FLAGS)
    assert len(cells) == 3
    assert cells.rows.tolist() == [0, 2, 2]
    assert cells.columns.tolist() == [1, 0, 2]
    assert cells.of(VALUES).tolist() == [2, 7, 9]


def test_what_is_said_of_columns_alone():
    by_column = np.array([10, 20, 30])
    assert Cells.at(FLAGS).of(by_column).tolist() == [20, 10, 30]
    assert Cells.at(FLAGS).of(by_column[None]).tolist() == [20, 10, 30]


def test_some_of_them_and_back():
    cells = Cells.at(FLAGS).part(np.array([0, 2]))
    laid = cells.laid(cells.of(VALUES), -1)
    assert laid.tolist() == [[-1, 2, -1], [-1, -1, -1], [-1, -1, 9]]


def test_whole_drives_with_a_flag():
    # The first drive has one state, the second one two
    cells, spans = Cells.of_drives(FLAGS, EndToEnd((0, 1, 3)))
    assert list(zip(cells.rows.tolist(), cells.columns.tolist(), strict=True)) == [
        (0, 1),
        (0, 2),
        (2, 0),
        (2, 1),
        (2, 2),
    ]
    assert list(spans.bounds) == [0, 2, 3, 5]
    none, spans = Cells.of_drives(np.zeros((2, 3), dtype=bool), EndToEnd((0, 1, 3)))
    assert (len(none), list(spans.bounds)) == (0, [0])


def test_none():
    for flags in (np.zeros((2, 3), dtype=bool), np.zeros((0, 3), dtype=bool)):
        cells = Cells.at(flags)
        assert len(cells) == 0
        assert cells.laid(cells.of(np.ones(flags.shape))).sum() == 0
