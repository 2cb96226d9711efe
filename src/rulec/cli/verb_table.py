"""The verbs in groups, as in the help text, and the commands that they stand for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

VERB_GROUPS = {
    "Write rules": {
        "new": "Create a rulebook to start from.",
        "check": "Check rulebooks and vocabularies.",
        "fmt": "Format rulebooks and vocabularies.",
        "test": "Run the examples of rulebooks.",
        "analyze": "Find rules that have no effect, contradict each other, or weaken a treaty.",
        "lsp": "Serve an editor: diagnostics, completion, renaming and more.",
    },
    "Read and compare laws": {
        "list": "List rulebooks, rules, vocabularies, scenarios, codes and formats.",
        "show": "Show rules in English and as formulas, what they inherit and rest on.",
        "explain": "Explain the code of a message, or a word.",
        "diff": "Compare rulebooks: which is stricter where, with traces that show it.",
        "doc": "Write a rulebook as a document for lawyers.",
    },
    "Judge traffic": {
        "verify": "Judge traces and recorded traffic by rulebooks.",
        "find": "List the moments at which a formula holds in drives.",
        "monitor": "Judge a running trace by a rulebook, state by state.",
        "maneuvers": "Count and list the maneuvers that satisfy a rulebook, or write them.",
        "fleet": "Judge all drives of a fleet: many files, on one machine or on Ray or Spark.",
        "rates": "Compute how often rules are violated: per hour, per 1000 km, per opportunity.",
        "draw": "Draw drives, scenes over time, navigation graphs and traces.",
    },
    "Use rulec": {
        "compile": "Compile a rulebook to automata files, and check them.",
        "help": "Show the help of a command, the manual page, or a script for a shell.",
    },
}

VERBS = {verb: about for group in VERB_GROUPS.values() for verb, about in group.items()}

OTHER_QUESTIONS: Mapping[str, Mapping[str, tuple[str, str]]] = {
    "list": {
        "formats": (
            "reading.formats",
            "List the formats of recorded traffic and maps, and what each provides.",
        ),
    },
    "show": {
        "--tree": ("reading.tree", "Show what a rulebook inherits, overrides and drops."),
        "--audit": (
            "reading.audit",
            "Report what rulebooks are based on: missing sources and examples, omissions.",
        ),
    },
    "maneuvers": {
        "--traces": ("traffic.traces", "Write all maneuvers of a scenario as traces."),
        "--envelopes": (
            "traffic.envelopes",
            "Write the bounds of the cheapest satisfying maneuvers as a table.",
        ),
    },
    "compile": {
        "--check": (
            "using.compile_check",
            "Prove that compiled tables are equivalent to their formulas.",
        ),
    },
    "help": {
        "--man": ("using.man", "Write a manual page."),
        "--completion": ("using.completion", "Print a script that completes rulec's commands."),
    },
}
"""Verb -> the words that ask it something else -> the file that answers, and a description."""

_FOLDERS = dict(zip(VERB_GROUPS, ("writing", "reading", "traffic", "using"), strict=True))

COMMANDS: Mapping[str, tuple[str, str]] = {
    **{
        verb: (f"{_FOLDERS[title]}.{verb}", about)
        for title, verbs in VERB_GROUPS.items()
        for verb, about in verbs.items()
    },
    **{
        f"{verb} {word}": answer
        for verb, words in OTHER_QUESTIONS.items()
        for word, answer in words.items()
    },
}
"""Command, such as ``show`` or ``show --tree`` -> its file and a description."""

FORMER = {
    "audit": "show --audit",
    "completion": "help --completion",
    "envelopes": "maneuvers --envelopes",
    "formats": "list formats",
    "man": "help --man",
    "traces": "maneuvers --traces",
    "tree": "show --tree",
    "verify-compiled": "compile --check",
}
"""Verbs of the version before, and what is typed instead of them."""

WITH_COMPILED = (
    *("compile --check", "draw", "fleet", "maneuvers", "maneuvers --envelopes"),
    *("maneuvers --traces", "monitor", "show", "verify"),
)
"""The commands that accept compiled rulebooks."""


def called(words: Sequence[str]) -> tuple[str, list[str]]:
    """The command that the words of a command line call, and its own arguments."""
    verb, *flag = FORMER.get(words[0], words[0]).split()
    arguments = [*flag, *words[1:]]
    # What follows `--` is no option.
    end = arguments.index("--") if "--" in arguments else len(arguments)
    word = next((word for word in OTHER_QUESTIONS.get(verb, ()) if word in arguments[:end]), None)
    if word is None:
        return verb, arguments
    arguments.remove(word)
    return f"{verb} {word}", arguments
