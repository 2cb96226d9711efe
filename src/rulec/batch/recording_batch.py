"""Many files of recorded traffic, judged in one process or in several, in the files' order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from rulec.batch.batch_messages import process_lost
from rulec.batch.jobs import Jobs, LostTask
from rulec.batch.recording_judge import JudgeSettings, Piece, judge
from rulec.batch.worker_pool import in_order

LARGE_BYTES = 1_000_000
"""Judging files of this total size (bytes) takes long enough to start processes at once."""


def judged_files(
    settings: JudgeSettings,
    files: Sequence[str],
    jobs: Jobs,
    tell: Callable[[int], object],
    lost: Callable[[str, int | None], object],
) -> Iterator[tuple[str, Piece]]:
    """Each file with each piece of its result.

    ``tell`` is called with the number of finished files; ``lost`` with a file whose process was
    killed, and the signal, before the file is judged again.
    """
    if _size(files) >= LARGE_BYTES:
        jobs = replace(jobs, alone_s=0.0)
    for file, piece in in_order(partial(judge, settings), files, jobs, tell, lost):
        if isinstance(piece, LostTask):
            yield file, process_lost(settings.labels.get(file, file), piece.signal_number)
        else:
            yield file, piece


def _size(files: Sequence[str]) -> int:
    """The total size of the first thousand files in bytes, which is enough for an estimate."""
    return sum(path.stat().st_size for path in map(Path, files[:1000]) if path.is_file())
