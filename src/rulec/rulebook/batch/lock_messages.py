"""Messages about ``rulec.lock``."""

from __future__ import annotations

from rulec.diagnostics.code import Code

NOT_AS_LOCKED = Code(
    "R0725",
    title="what ships with rulec is not what a project has locked",
    why="Into `rulec.lock` goes, by `rulec check --lock`, the hash (SHA-256) of every rulebook and "
    "vocabulary that ships with rulec and that the rulebooks of a project build upon. Another "
    "release of rulec may have another law of the same name. Then `rulec check` says which file "
    "differs, until the project has looked at what has changed and locks it anew.",
    kind="circumstance",
)

WRONG_LOCK = Code(
    "R0726",
    title="a lock file cannot be understood",
    why="A `rulec.lock` is TOML, a line for each file that ships with rulec: its path in quotes, "
    "`=`, and the SHA-256 of its content in quotes. `rulec check --lock` writes it.",
    bad="echo 'de' > rulec.lock\nrulec check esterle2019",
    good="rulec check --lock esterle2019\nrulec check esterle2019",
    kind="command",
)
