"""Temporary files that cannot be written are named as such, and nothing else is."""

import errno

import pytest

import rulec
from rulec.files.written_files import temporary_files


@pytest.mark.parametrize(
    ("problem", "is_ours"),
    [
        (OSError(errno.ENOSPC, "No space left on device"), True),
        (OSError(errno.EDQUOT, "Disk quota exceeded"), True),
        (FileNotFoundError(errno.ENOENT, "No usable temporary directory found"), True),
        (OSError(errno.ENOSPC, "No space left on device", "/tmp/rulec-abc"), True),
        (OSError(errno.ENOENT, "No such file or directory", "cc"), False),
        (OSError(errno.EAGAIN, "Resource temporarily unavailable"), False),
    ],
)
def test_only_what_is_about_temporary_files_is_said_of_them(problem, is_ours):
    with pytest.raises(rulec.RulecError if is_ours else OSError) as caught, temporary_files():
        raise problem
    assert (caught.value is problem) is not is_ours
