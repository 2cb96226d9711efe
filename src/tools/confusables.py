"""Write ``grammar/confusables.json``: letters that look like other letters.

Run ``python -m tools.confusables`` in an environment with ``confusable-homoglyphs==3.3.1``, whose
data are Unicode's ``confusables.txt`` (UTS #39). It is not part of regeneration: it changes with
Unicode.
"""

from __future__ import annotations

import json
from collections import defaultdict
from importlib.resources import files
from pathlib import Path
from typing import Any

TABLE = Path(__file__).resolve().parents[2] / "grammar" / "confusables.json"
SOURCE = (
    "Unicode Technical Standard #39, confusables.txt (https://www.unicode.org/Public/security/), "
    "as in confusable-homoglyphs 3.3.1; Copyright Unicode, Inc., Unicode License V3 "
    "(https://www.unicode.org/license.txt)"
)


def confusables(data: dict[str, list[dict[str, str]]]) -> dict[str, str]:
    """Characters of names -> the non-ASCII letters that look like them."""
    like = defaultdict(list)
    for letter, looks in data.items():
        prototypes = [look["c"] for look in looks]
        is_one = len(letter) == 1 and len(prototypes) == 1
        if is_one and not letter.isascii() and f"a{letter}{prototypes[0]}".isidentifier():
            like[prototypes[0]].append(letter)
    return {prototype: "".join(sorted(like[prototype])) for prototype in sorted(like)}


def main() -> None:
    """Write the table."""
    text = files("confusable_homoglyphs").joinpath("confusables.json").read_text("utf-8")
    data: dict[str, Any] = json.loads(text)
    table = {"source": SOURCE, "alike": confusables(data)}
    TABLE.write_text(json.dumps(table, ensure_ascii=False, indent=0) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
