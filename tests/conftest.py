"""Settings shared by all tests."""

import gc
import os
from pathlib import Path
from shutil import rmtree, which
from tempfile import mkdtemp

import pytest
from hypothesis import HealthCheck, settings

from rulec.automata import compiler, prefix_machines
from rulec.cache.keeping import keeping
from support import hidden_spot
from support.kept_for_a_run import FOLDER
from support.remembered_books import remember_books
from support.remembered_machines import ASKED, remembering
from support.snapshots import Snapshots
from tools.browser.chromium import chromium as started_chromium

# The quick profile tries the same examples each time, so that a red run is about the change; the
# long one looks for new ones.
settings.register_profile(
    "quick",
    max_examples=30,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.register_profile(
    "long", max_examples=5000, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile(os.environ.get("RULEC_TEST_PROFILE", "quick"))

# As many processes as there are processors run tests; commands in them start no more.
os.environ.setdefault("RULEC_JOBS", "1")

# As commands have it: what thousands of tests keep need not be looked through so often.
gc.set_threshold(400_000)


def pytest_collection_modifyitems(items):
    """Leave what is marked ``long`` to the long profile, and ``spot`` to who has Spot."""
    if os.environ.get("RULEC_TEST_PROFILE") != "long":
        for item in items:
            if item.get_closest_marker("long"):
                item.add_marker(pytest.mark.skip(reason="takes long: --long"))
    if not hidden_spot.is_there():
        for item in items:
            if item.get_closest_marker("spot"):
                item.add_marker(pytest.mark.skip(reason="Spot is not installed"))


def pytest_configure(config):
    """Keep caches for the run, before modules are collected, some of which compile rulebooks.

    Tests neither use what the user's own checks have left, nor leave anything there. What one test
    has compiled is not compiled again by another, but in the long profile.
    """
    if FOLDER not in os.environ:
        os.environ[FOLDER] = mkdtemp(prefix="rulec-tests-")
        config.add_cleanup(lambda: rmtree(os.environ.pop(FOLDER)))
    kept = Path(os.environ[FOLDER])
    os.environ["RULEC_CACHE_DIR"] = str(kept / "cache")
    # How long something takes, on a busy machine, is no part of what a test sees.
    os.environ["RULEC_QUIET"] = "1"
    if hidden_spot.VARIABLE in os.environ:
        hidden_spot.hide(kept / "hidden")
    if os.environ.get("RULEC_TEST_PROFILE") != "long":
        (kept / "machines").mkdir(exist_ok=True)
        answers = remembering(kept / "machines")
        compiler.answers_to = prefix_machines.answers_to = answers
        remember_books()


@pytest.fixture(scope="module")
def compiled_anew():
    """For tests of the compiler itself: nothing is remembered, and nothing that ships is taken."""
    with pytest.MonkeyPatch.context() as patch, keeping(on=False):
        patch.setattr(compiler, "answers_to", ASKED)
        patch.setattr(prefix_machines, "answers_to", ASKED)
        yield


def pytest_addoption(parser):
    parser.addoption(
        "--refresh-snapshots", action="store_true", help="store texts anew instead of comparing"
    )


@pytest.fixture
def snapshots(request):
    """The texts in the folder ``snapshots`` beside the test."""
    refresh = request.config.getoption("--refresh-snapshots")
    return Snapshots(request.path.parent / "snapshots", refresh=refresh)


@pytest.fixture(scope="module")
def chromium():
    """A headless Chromium; no other may run beside it in this process."""
    if which("npm") is None:
        pytest.skip("npm is not there, which Chromium comes from")
    with started_chromium() as browser:
        yield browser
