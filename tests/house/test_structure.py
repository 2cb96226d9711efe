"""Sizes of folders and of lists of parameters, and imports within functions."""

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


REASON_OF_A_FILE = "# Imports within functions: "


def unexplained_imports():
    """Files that import within a function without a comment beside or above that says why.

    A comment of the module's own, at the beginning of a line, gives the reason for all of a file.
    """
    for module in source_modules():
        if any(line.startswith(REASON_OF_A_FILE) for line in module.lines):
            continue
        for number in sorted(module.inner_imports):
            above = number - 1
            while above in module.inner_imports:
                above -= 1
            if "# " not in module.lines[number - 1] and "# " not in module.lines[above - 1]:
                yield module.name


def test_an_import_within_a_function_has_its_reason():
    assert set(unexplained_imports()) == set()
