"""Compiled rulebooks' files whose content has been changed, with the digest made anew."""

import json

from rulec.automata.bundle.bundle_file import with_digest


def sealed(data):
    """The bytes of a file that says ``data``, and whose digest is right."""
    rest = {key: value for key, value in data.items() if key != "sha256"}
    return with_digest(json.dumps(rest, indent=1)).encode()
