"""Messages about compiled rulebooks on disk."""

from __future__ import annotations

from rulec.diagnostics.code import Code

DAMAGED_BUNDLE = Code(
    "R0404",
    title="a compiled rulebook is damaged or of another version",
    why="A compiled rulebook is read as a whole and checked before it judges anything. If it was "
    "cut off, edited, or written by a version of rulec that this one does not understand, "
    "compile the source again.",
    bad="rulec compile esterle2019 -o build > log\n"
    "head -c 5000 build/esterle2019.json > part.json\n"
    "rulec maneuvers s2 -r part.json",
    good="rulec compile esterle2019 -o build > log\nrulec maneuvers s2 -r build/esterle2019.json",
    kind="command",
)
