"""Sizes of folders and of lists of parameters."""

import pytest

from support.source_modules import PACKAGE, rooms, source_modules

MOST_FILES = 15


@pytest.mark.parametrize("folder", list(rooms()), ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_folder_can_be_seen_at_a_glance(folder):
    assert len(list(folder.glob("*.py"))) <= MOST_FILES


def test_nothing_has_more_than_five_positional_parameters():
    """Neither a definition nor a call, nor by a tuple that is laid out in a call."""
    found = {f"{x.name} {name}" for x in source_modules() for name in (*x.wide, *x.laid_out)}
    assert found == set()
