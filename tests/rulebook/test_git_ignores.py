"""What git ignores, as git itself says it."""

import os
import subprocess

import pytest

from rulec.rulebook.files.git_ignores import ignore_files, is_ignored, pattern_of

PATHS = [
    *("a.rules", "b.rules", "build/x.rules", "build/keep/x.rules", "deep/build/y.rules"),
    *("deep/a.rules", "deep/er/a.rules", "docs/z.rules", "docs/in/z.rules", "we ird.rules"),
    *("!bang.rules", "#hash.rules", "a[1].rules", "ab.rules", "x/y/z/t.rules", "end "),
]
PATTERNS = [
    *("*.rules", "/a.rules", "a.rules", "build/", "build", "/build/", "deep/*", "deep/**", "**/er"),
    *("**/build/*.rules", "x/**/t.rules", "x/**/z/**", "docs/*.rules", "?b.rules", "[ab].rules"),
    *("[!a].rules", "[^a]b.rules", r"\#hash.rules", r"\!bang.rules", "#hash.rules", r"a\[1].rules"),
    *("we ird.rules  ", r"end\ ", "[[:alpha:]].rules", "*r*l*s", "a[[]1].rules", "**", "[a", "er/"),
    *("deep/er", "deep/e?/", "x/*/t.rules", "/*", "!a.rules", "x/y/z/t.rules/", "]", "a**", "**a"),
]


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    top = tmp_path_factory.mktemp("tree")
    subprocess.run(["git", "init", "-q", str(top)], check=True)
    for path in PATHS:
        (top / path).parent.mkdir(parents=True, exist_ok=True)
        (top / path).write_text("")
    return top


def ignored_here(top):
    """The paths that are ignored, a folder standing for what is in it."""
    found = set()
    for path in PATHS:
        parts = path.split("/")
        for n in range(1, len(parts) + 1):
            at = top.joinpath(*parts[:n])
            if is_ignored(at, ignore_files(at.parent, top), is_folder=at.is_dir()):
                found.add(path)
    return found


def ignored_by_git(top):
    done = subprocess.run(
        ["git", "-c", "core.excludesFile=/dev/null", "check-ignore", "-z", "--stdin"],
        cwd=top,
        input="\0".join(PATHS).encode(),
        capture_output=True,
        check=False,
    )
    assert done.returncode in (0, 1), done.stderr
    return set(filter(None, done.stdout.decode().split("\0")))


@pytest.mark.parametrize("pattern", PATTERNS)
def test_each_pattern(pattern, tree):
    (tree / ".gitignore").write_text(pattern + "\n")
    assert ignored_here(tree) == ignored_by_git(tree)


def test_patterns_together_and_in_several_files(tree):
    (tree / ".gitignore").write_text("*.rules\r\n!ab.rules\n!deep/\n# nothing\n\nbuild\n")
    (tree / "deep" / ".gitignore").write_text("!a.rules\n/er/\n")
    (tree / ".git" / "info" / "exclude").write_text("end*\nab.rules\n")
    assert ignored_here(tree) == ignored_by_git(tree)
    assert "ab.rules" not in ignored_here(tree)
    (tree / "deep" / ".gitignore").unlink()
    (tree / ".git" / "info" / "exclude").write_text("")


def test_a_hostile_pattern_takes_few_steps():
    """As many stars as a line has place for: each name is gone through a few hundred times."""
    pattern = pattern_of("*a" * 2000 + "b")
    assert pattern is not None
    assert not pattern.matches(["a" * 255], is_folder=False)
    shorter = pattern_of("*?a" * 120 + "*b")
    assert shorter is not None
    assert not shorter.matches(["a" * 255], is_folder=False)
    assert shorter.matches([f"{'a' * 254}b"], is_folder=False)
    deep = pattern_of("**/a/" * 200 + "b")
    assert deep is not None
    assert not deep.matches(["a"] * 400, is_folder=False)


@pytest.mark.parametrize("name", [".gitignore", ".git/info/exclude"])
def test_a_linked_list_of_patterns_and_a_pipe_are_not_read(name, tree, tmp_path):
    (tmp_path / "secret").write_text("*.rules\n")
    (tree / name).unlink(missing_ok=True)
    (tree / name).symlink_to(tmp_path / "secret")
    assert ignored_here(tree) == set()
    (tree / name).unlink()
    os.mkfifo(tree / name)
    assert ignored_here(tree) == set()
    (tree / name).unlink()
