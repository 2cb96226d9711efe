"""What a browser refuses of a page by the page's own policy (Content Security Policy, level 3)."""

from base64 import b64encode
from hashlib import sha256
from html.parser import HTMLParser

_DATA_BLOCKS = ("application/json",)


class _Elements(HTMLParser):
    def __init__(self, page):
        super().__init__()
        self.policy, self.texts, self.attributes, self._open = (
            "",
            {"style": [], "script": []},
            [],
            "",
        )
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        if found.get("http-equiv") == "Content-Security-Policy":
            self.policy = found["content"]
        self.attributes += [name for name in found if name == "style" or name.startswith("on")]
        if tag in self.texts and found.get("type") not in _DATA_BLOCKS:
            self._open = tag
            self.texts[tag].append("")

    def handle_data(self, data):
        if self._open:
            self.texts[self._open][-1] += data

    def handle_endtag(self, tag):
        self._open = ""


def hash_of(text):
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def check_policy(page):
    """The page may use its own styles and scripts, by their hashes, and nothing else."""
    elements = _Elements(page)
    allowed = dict(part.split(maxsplit=1) for part in elements.policy.split("; "))
    assert allowed.pop("default-src") == "'none'"
    own = {f"{tag}-src": {*map(hash_of, texts)} for tag, texts in elements.texts.items()}
    assert {kind: {*sources.split()} for kind, sources in allowed.items()} == {
        kind: sources or {"'none'"} for kind, sources in own.items()
    }
    assert elements.attributes == [], "no hash allows styles and scripts in attributes"
