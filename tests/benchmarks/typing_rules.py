"""How long the language server takes after a keystroke: to check what is shown, and to say it.

A session that was written down key by key, slips and corrections included, is typed into Germany's
rulebook: a rule whose brace is closed last, a definition and its use, a parameter's value, an
example, and a rule's condition replaced word by word. Processor time of what follows each key: the
text is parsed, the rulebook resolved, and every diagnostic made for the editor.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from figure import Figure, Result
from program import run

from rulec.language_server.workspace.editor_workspace import EditorWorkspace
from rulec.language_server.workspace.published_diagnostics import diagnostics_of
from rulec.resources import rulebooks_folder

BACK = "\b"
MOST_MS = 50

SESSION = (
    (
        "drop   rule queue_weaving",
        "hard rule keep_clear_of_tracks in emergncy" + 4 * BACK + "ency {\n"
        '  cite    "§ 19(4)"\n'
        '  says    "Do not stop on tracks."\n'
        "  certainty unverified\n"
        "  require never (level_crossing_zone an speed" + 6 * BACK + "d speed < 3 km/h)\n"
        "  unless congested at sme" + 2 * BACK + "ome point\n"
        '  accept  "it goes on" { level_crossing_zone and speed = 30 km/h }\n'
        "  reject  { level_crossing_zone and speed = 0 km/h }\n"
        "}\n\n",
    ),
    ("param advisory_limit", "param crawling : sped" + BACK + "ed = 12 km/h\n"),
    ("# § 18: what is for motorways", "define creeps = speed < crawling and not congested\n\n"),
    ('  accept  "a green arrow"', "  unless creeps at some point\n"),
    (" = 20 km/h  # § 7(2a)", " = 25 km/h + 1 km/h"),
    ("  reject  { red_cross }", '  accept  "nothing" { not red_cross; green_light }\n'),
    ("red_cross\n  unless creeps", "(red_cross or amber_light)" + 27 * BACK),
)
"""Before what is written something is typed; ``BACK`` takes back the letter before it."""


def keystrokes(text: str) -> Iterator[str]:
    """The text after each key."""
    for before, typed in SESSION:
        at = text.find(before)
        if at < 0:
            continue
        for key in typed:
            if key == BACK:
                text, at = text[: at - 1] + text[at:], at - 1
            else:
                text, at = text[:at] + key + text[at:], at + 1
            yield text


def session_ms(texts: list[str], folder: Path) -> list[float]:
    """How long each key takes, in ms, after the document has been opened."""
    workspace = EditorWorkspace((folder,))
    uri = (folder / "de.rules").as_uri()
    document = workspace.open(uri, texts[0])
    workspace.check(document)
    taken = []
    for text in texts[1:]:
        begun = time.process_time()
        found = workspace.check(workspace.open(uri, text)).findings
        diagnostics_of(found, text, workspace)
        taken.append((time.process_time() - begun) * 1000)
    return taken


def measure(rounds: int) -> Iterator[Result]:
    """The session, several times."""
    book = (rulebooks_folder() / "de" / "de.rules").read_text(encoding="utf-8")
    texts = [book, *keystrokes(book)]
    with TemporaryDirectory() as folder:
        sessions = [sorted(session_ms(texts, Path(folder))) for _ in range(rounds)]
    p95 = [one[int(0.95 * len(one))] for one in sessions]
    middle = [statistics.median(one) for one in sessions]
    yield Result(
        "Typing",
        f"Germany's rulebook, {len(book):,} characters, and {len(texts) - 1} keystrokes that were "
        "written down",
        [
            Figure("95 of 100 keystrokes", "ms", statistics.median(p95), min(p95), MOST_MS),
            Figure("one keystroke of two", "ms", statistics.median(middle), min(middle)),
        ],
        [f"the slowest keystroke took {min(one[-1] for one in sessions):.0f} ms"],
    )


if __name__ == "__main__":
    run(measure, 3)
