"""Files that git ignores, by ``.gitignore`` as described in gitignore(5).

This is not a library's implementation, since the patterns may come from strangers: matching takes
time proportional to the length of pattern times name, however many ``*`` there are. The user's own
patterns (`core.excludesFile`) are not read, so that a check gives the same result on every machine.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from rulec.files.work_trees import is_ordinary, leads_out

MOST_BYTES = 100_000
"""The most bytes of a file of patterns; the rest is ignored."""

_NAMED_CLASS = re.compile(r"\[:(\w+):\]")
_CLASSES = {
    "alnum": "a-zA-Z0-9",
    "alpha": "a-zA-Z",
    "blank": r" \t",
    "digit": "0-9",
    "lower": "a-z",
    "space": r"\s",
    "upper": "A-Z",
    "xdigit": "0-9a-fA-F",
}

_LONGEST_NAME = 255
_NOTHING = re.compile(r"(?!)")


@dataclass(frozen=True, slots=True)
class IgnorePattern:
    """A line of a ``.gitignore`` file: the parts between slashes, and what they apply to."""

    parts: tuple[str, ...]
    includes: bool
    folders_only: bool

    def matches(self, names: Sequence[str], *, is_folder: bool) -> bool:
        """Whether it matches a path, given by its names below the file of patterns."""
        return (is_folder or not self.folders_only) and _fit(self.parts, names)


@dataclass(frozen=True, slots=True)
class IgnoreFile:
    """The patterns of one file, for paths below its folder; the last match decides."""

    folder: Path
    patterns: tuple[IgnorePattern, ...]

    def verdict(self, path: Path, *, is_folder: bool) -> bool | None:
        """True if a path is ignored, False if it is included again, None without a match."""
        names = path.relative_to(self.folder).parts
        for pattern in reversed(self.patterns):
            if pattern.matches(names, is_folder=is_folder):
                return not pattern.includes
        return None


def is_ignored(path: Path, files: Sequence[IgnoreFile], *, is_folder: bool) -> bool:
    """Whether git ignores a path, by files of patterns with the nearest one last."""
    verdicts = (file.verdict(path, is_folder=is_folder) for file in reversed(files))
    return next((verdict for verdict in verdicts if verdict is not None), False)


def ignore_files(folder: Path, tree: Path) -> list[IgnoreFile]:
    """The patterns of a folder and of all above it up to the top of its work tree."""
    above = [place for place in folder.parents if place == tree or tree in place.parents]
    files = _patterns_of(tree / ".git" / "info" / "exclude", tree, tree)
    for place in (*reversed(above), folder):
        files += patterns_in(place, tree)
    return files


def patterns_in(folder: Path, tree: Path) -> list[IgnoreFile]:
    """The patterns of a folder's own ``.gitignore``, if it has one."""
    return _patterns_of(folder / ".gitignore", folder, tree)


def _patterns_of(file: Path, folder: Path, tree: Path) -> list[IgnoreFile]:
    if not is_ordinary(file) or leads_out(file, tree):
        return []
    return [IgnoreFile(folder, _patterns(file))]


def _patterns(file: Path) -> tuple[IgnorePattern, ...]:
    try:
        with file.open("rb") as stream:
            text = stream.read(MOST_BYTES).decode("utf-8-sig", "surrogateescape")
    except OSError:
        return ()
    return tuple(filter(None, map(pattern_of, text.split("\n"))))


def pattern_of(line: str) -> IgnorePattern | None:
    """The pattern of a line; None for comments and what cannot match."""
    line = line.removesuffix("\r")
    if line.startswith("#"):
        return None
    while line.endswith(" ") and not line.endswith("\\ "):
        line = line[:-1]
    includes = line.startswith("!")
    line = line.removeprefix("!")
    folders_only = line.endswith("/")
    line = line.removesuffix("/")
    if not line:
        return None
    # With a slash in it a pattern is about that very place, else about names at any depth.
    anchored = "/" in line
    parts = tuple(line.removeprefix("/").split("/"))
    return IgnorePattern(parts if anchored else ("**", *parts), includes, folders_only)


@lru_cache(maxsize=4096)
def _expression(part: str) -> re.Pattern[str]:
    """A part as a regular expression that never backtracks to an earlier ``*``."""
    signs = _signs(part)
    if sum(sign != "*" for sign in signs) > _LONGEST_NAME:
        return _NOTHING
    first, *others = _between_stars(signs)
    # What a look ahead has found stays as it is: the nearest place is as good as any later one.
    middle = [f"(?=(?P<g{n}>.*?{pattern}))(?P=g{n})" for n, pattern in enumerate(others[:-1])]
    try:
        return re.compile(
            "".join([first, *middle, *(f".*{pattern}" for pattern in others[-1:])]), re.DOTALL
        )
    except re.error:  # a class of signs that is none
        return _NOTHING


def _between_stars(signs: Sequence[str]) -> list[str]:
    """Regular expressions for the text before, between and after the ``*``."""
    patterns = [""]
    for sign in signs:
        if sign == "*":
            patterns.append("")
        else:
            patterns[-1] += _of_sign(sign)
    return patterns


def _of_sign(sign: str) -> str:
    if sign == "?":
        return "."
    return re.escape(sign[1:]) if sign.startswith("\\") else _class(sign)


def _fit(pattern: Sequence[str], names: Sequence[str]) -> bool:
    """Match a path; ``**`` stands for any number of names.

    Only the last ``**`` is extended, since where an earlier one ends makes no difference.
    """
    # Behind the last part, `**` is everything inside, but not the folder itself.
    least = 1 if pattern and len(pattern) > 1 and pattern[-1] == "**" else 0
    at = here = 0
    again: tuple[int, int] | None = None
    while here < len(names):
        if at < len(pattern) and pattern[at] == "**":
            again = (at, here)
            at += 1
        elif at < len(pattern) and _expression(pattern[at]).fullmatch(names[here]):
            at += 1
            here += 1
        elif again is not None:
            again = (again[0], again[1] + 1)
            at, here = again[0] + 1, again[1]
        else:
            return False
    left = pattern[at:]
    return all(part == "**" for part in left) and not (least and len(left) == 1)


@lru_cache(maxsize=4096)
def _signs(part: str) -> tuple[str, ...]:
    """A part as signs: `*`, `?`, a class in brackets, or a backslash and a character."""
    signs: list[str] = []
    at = 0
    while at < len(part):
        sign = part[at]
        end = part.find("]", at + (3 if part[at + 1 : at + 2] in ("!", "^") else 2))
        while end > 0 and part.rfind("[:", at + 1, end) > part.rfind(":]", at + 1, end):
            end = part.find("]", end + 1)
        if sign == "[" and end > 0:
            signs.append(part[at : end + 1])
            at = end + 1
            continue
        if sign == "\\":
            at += 1
            sign = part[at : at + 1]
            signs.append(f"\\{sign}")
        elif sign in "*?":
            signs += [] if sign == "*" and signs[-1:] == ["*"] else [sign]
        else:
            signs.append(f"\\{sign}")
        at += 1
    return tuple(signs)


def _class(sign: str) -> str:
    inside = sign[1:-1]
    negated = inside[:1] in ("!", "^")
    inside = inside[1:] if negated else inside
    classes = "".join(_CLASSES.get(name, "") for name in _NAMED_CLASS.findall(inside))
    escaped = re.sub(r"[\[\]^&~|]", r"\\\g<0>", _NAMED_CLASS.sub("", inside))
    return f"[{'^' if negated else ''}{escaped}{classes}]"
