"""Two recordings held against each other, field by field."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass

import numpy as np


def assert_same(ours, theirs, where="recording"):
    """All that two values hold is the same, exactly and in the same order."""
    if is_dataclass(ours):
        assert type(ours) is type(theirs), where
        for one in fields(ours):
            assert_same(getattr(ours, one.name), getattr(theirs, one.name), f"{where}.{one.name}")
    elif isinstance(ours, np.ndarray):
        assert isinstance(theirs, np.ndarray), where
        assert ours.tolist() == theirs.tolist(), where
    elif isinstance(ours, Mapping):
        assert list(ours) == list(theirs), where
        for key, value in ours.items():
            assert_same(value, theirs[key], f"{where}[{key}]")
    elif isinstance(ours, tuple):
        assert len(ours) == len(theirs), where
        for number, (one, other) in enumerate(zip(ours, theirs, strict=True)):
            assert_same(one, other, f"{where}[{number}]")
    else:
        assert (type(ours), ours) == (type(theirs), theirs), where
