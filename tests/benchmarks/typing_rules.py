"""How long the language server takes after a keystroke: to check what is shown, and to say it.

A stored session, with slips, corrections, pauses, deletions and pasted rules, is typed into
Germany's rulebook. Processor time of what follows each key: the text is parsed, the rulebook
resolved, and every diagnostic made for the editor. What the server does in pauses of two seconds is
done, and not counted.
"""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from figure import Figure, Result
from program import run

from rulec.language_server.editor_session import REST_S, collect_in_pauses
from rulec.language_server.workspace.editor_workspace import EditorWorkspace
from rulec.language_server.workspace.published_diagnostics import diagnostics_of
from rulec.resources import rulebooks_folder
from support.typing.typing_session import typed

MOST_MS = 50


def session_ms(book: str, folder: Path) -> list[float]:
    """How long each key takes, in ms, after the document has been opened."""
    workspace = EditorWorkspace((folder,))
    uri = (folder / "de.rules").as_uri()
    workspace.check(workspace.open(uri, book))
    taken = []
    for waited, text in typed(book):
        if waited >= REST_S:
            workspace.rest()
            gc.collect()
        begun = time.process_time()
        found = workspace.check(workspace.open(uri, text)).findings
        diagnostics_of(found, text, workspace)
        taken.append((time.process_time() - begun) * 1000)
    return taken


def measure(rounds: int) -> Iterator[Result]:
    """The session, several times."""
    collect_in_pauses()
    book = (rulebooks_folder() / "de" / "de.rules").read_text(encoding="utf-8")
    with TemporaryDirectory() as folder:
        sessions = [sorted(session_ms(book, Path(folder))) for _ in range(rounds)]
    p95 = [one[int(0.95 * len(one))] for one in sessions]
    middle = [statistics.median(one) for one in sessions]
    slowest = [one[-1] for one in sessions]
    yield Result(
        "Typing",
        f"Germany's rulebook, {len(book):,} characters, and a stored session of "
        f"{len(sessions[0])} keystrokes",
        [
            Figure("95 of 100 keystrokes", "ms", statistics.median(p95), min(p95), MOST_MS),
            Figure("one keystroke of two", "ms", statistics.median(middle), min(middle)),
            Figure("the slowest keystroke", "ms", statistics.median(slowest), min(slowest)),
        ],
    )


if __name__ == "__main__":
    run(measure, 3)
