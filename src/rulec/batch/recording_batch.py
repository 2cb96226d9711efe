"""Many files of recorded traffic, judged in one process or in several, in their order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from rulec.batch.batch_messages import process_lost
from rulec.batch.recording_judge import JudgeSettings, Piece, judge
from rulec.batch.worker_pool import LostTask, in_order


def judged_files(
    settings: JudgeSettings,
    files: Sequence[str],
    jobs: int,
    tell: Callable[[int], object],
) -> Iterator[tuple[str, Piece]]:
    """Each file with each piece of its answer; ``tell`` is told how many files are done."""
    for file, piece in in_order(partial(judge, settings), files, jobs, tell):
        if isinstance(piece, LostTask):
            yield file, process_lost(settings.labels.get(file, file), piece.signal_number)
        else:
            yield file, piece
