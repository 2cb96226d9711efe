"""Messages about ``rulec.lock``."""

from __future__ import annotations

from rulec.diagnostics.code import Code

NOT_AS_LOCKED = Code(
    "R0725",
    title="a shipped file is not the one that a project has locked",
    why="A `rulec.lock`, written by `rulec check --lock`, has the hash (SHA-256) of every shipped "
    "rulebook and vocabulary that the rulebooks of a project build upon. Another release of rulec "
    "may have another law under the same name. Then `rulec check` reports which file differs, "
    "until you have reviewed the change and locked it again.",
    kind="circumstance",
)

WRONG_LOCK = Code(
    "R0726",
    title="a lock file is invalid",
    why="A `rulec.lock` is TOML with a line for each shipped file: its path in quotes, `=`, and "
    "the SHA-256 of its content in quotes. `rulec check --lock` writes it.",
    bad="echo 'de' > rulec.lock\nrulec check esterle2019",
    good="rulec check --lock esterle2019\nrulec check esterle2019",
    kind="command",
)
