"""The kinds of findings of an audit; a module of its own so that shells complete them quickly."""

from __future__ import annotations

from typing import Final

KINDS: Final = {
    "uncited": "no provision of the law is cited",
    "inherited": "the law of a book that this one extends, not confirmed as its own",
    "untested": "it lacks an example that it accepts, or one that it rejects",
    "failing": "an example comes out otherwise than it says",
    "unverified": "written from memory",
    "secondary": "taken from a secondary source, not from the law itself",
    "unstated": "nothing is said about its certainty",
    "soft-only": "an article of which all rules are soft",
    "softened": "an inherited hard rule that was made soft",
    "dropped": "an inherited rule that was taken out",
    "silent": "what the rulebook says nothing about",
    "dated": "in force for a time only",
    "out-of-force": "not in force on the day in question, and left out",
    "to-do": "an article that no rule cites, and of which nothing is said",
    "unlisted": "a rule cites an article that the rulebook does not list",
    "not-found": "what a rule cites is not in the text of the law",
    "unread": "what a rule cites names no article that could be looked for",
    "law-changed": "the text of the law has changed where a rule rests on it",
    "unused": "a word that no rule speaks of",
}
"""The kinds of findings and their meanings."""
