"""The kinds of findings of an audit; a module of its own so that shells complete them quickly."""

from __future__ import annotations

from typing import Final

KINDS: Final = {
    "uncited": "no provision of the law is cited",
    "inherited": "the law of a book that this one extends, not confirmed as its own",
    "untested": "it lacks an example that it accepts, or one that it rejects",
    "failing": "an example does not have the result that it states",
    "unverified": "written from memory",
    "secondary": "taken from a secondary source, not from the law itself",
    "unstated": "nothing is said about its certainty",
    "soft-only": "an article that only soft rules cite",
    "softened": "an inherited hard rule that was made soft",
    "dropped": "an inherited rule that was dropped",
    "silent": "a topic that the rulebook or its base deliberately leaves out",
    "dated": "in force for a limited time only",
    "out-of-force": "not in force on the audit's day, and left out",
    "to-do": "an article that no rule cites and the rulebook does not explain",
    "unlisted": "a rule cites an article that the rulebook does not list",
    "not-found": "a rule cites a place that is not in the text of the law",
    "unread": "a rule's citation names no article to look up",
    "law-changed": "the text of the law has changed where a rule rests on it",
    "unused": "a word that no rule uses",
}
"""The kinds of findings and their meanings."""
