"""The verbs in groups, as in the help text, each with a one-line description."""

from __future__ import annotations

VERB_GROUPS = {
    "Write rules": {
        "new": "Create a rulebook to start from.",
        "check": "Check rulebooks and vocabularies.",
        "fmt": "Format rulebooks and vocabularies.",
        "test": "Run the examples of rulebooks.",
        "show": "Show a rule in English, as a formula, as an automaton, with examples.",
        "explain": "Explain the code of a message, or a word.",
        "lsp": "Serve an editor: diagnostics, completion, renaming and more.",
        "list": "List the available rulebooks, vocabularies, scenarios or codes.",
    },
    "Judge traffic": {
        "verify": "Judge traces and recorded traffic by rulebooks.",
        "find": "List the moments at which a formula holds in drives.",
        "monitor": "Judge a running trace by a rulebook, state by state.",
        "maneuvers": "Count and list the maneuvers that satisfy a rulebook.",
        "fleet": "Judge all drives of a fleet: many files, on one machine or on Ray or Spark.",
        "rates": "Compute how often rules are violated: per hour, per 1000 km, per opportunity.",
        "draw": "Draw drives, scenes over time, navigation graphs and traces.",
        "formats": "List the formats of recorded traffic and maps, and what each provides.",
    },
    "Compare laws": {
        "diff": "Compare two rulebooks: which is stricter where, with traces that show it.",
        "tree": "Show what a rulebook inherits, overrides and drops.",
        "analyze": "Find rules that have no effect, contradict each other, or weaken a treaty.",
        "audit": "Report what rulebooks are based on: missing sources and examples, omissions.",
    },
    "Hand over": {
        "doc": "Write a rulebook as a document for lawyers.",
        "compile": "Compile a rulebook to automata files.",
        "verify-compiled": "Prove that compiled tables are equivalent to their formulas.",
        "traces": "Write all maneuvers of a scenario as traces.",
        "envelopes": "Write the bounds of the cheapest satisfying maneuvers as a table.",
    },
    "Use rulec": {
        "help": "Show the help of a command.",
        "man": "Write a manual page.",
        "completion": "Print a shell script that completes rulec's commands.",
    },
}

VERBS = {verb: about for group in VERB_GROUPS.values() for verb, about in group.items()}

WITH_COMPILED = (
    *("draw", "envelopes", "fleet", "maneuvers", "monitor", "show", "traces", "verify"),
    "verify-compiled",
)
"""The verbs that accept compiled rulebooks."""
