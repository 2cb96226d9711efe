"""Messages about a lock, about comments that allow, and about a new rulebook's name."""

from __future__ import annotations

import re

from rulec.diagnostics import RulecError
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


UNFIT_ALLOWANCE = Code(
    "R0219",
    title="a comment allows nothing, or gives no reason",
    why="The comment `# rulec: allow CODE because REASON`, at the end of the line of a warning, "
    "suppresses that warning. Errors cannot be suppressed. Comments that suppress nothing are "
    "reported, so that they do not outlive their reason.",
    bad="rulebook example\nsignal p, q\nhard rule r { require always p }  "
    "# rulec: allow R0208 because q comes later\n",
    good="rulebook example\nsignal p\nparam pace = 7 km/h  # rulec: allow R0208 because a later "
    "rule reads it\nhard rule r { require always p }\n",
)


NO_NAME = Code(
    "R0738",
    title="a rulebook cannot have this name",
    why="A rulebook's name is used in its first line and in rulebooks that extend it: it consists "
    "of letters, digits, `_` and `-`, begins with a letter, and is not a word of the language.",
    bad="rulec new 'Belgium 2'",
    good="rulec new belgium_2",
    kind="command",
)


def no_name(name: str) -> RulecError:
    """``name`` cannot be a rulebook's."""
    plain = re.sub(r"\W+", "_", name).strip("_").lower()
    offered = plain if plain[:1].isalpha() and plain != name.lower() else f"my_{plain or 'rules'}"
    return NO_NAME.error(
        None,
        f"`{name}` cannot be the name of a rulebook",
        expected="expected letters, digits, `_`, `-`, a letter first, and no word of the language",
        help=f"such as `{offered[:60]}`",
    )
