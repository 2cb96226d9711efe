import pytest

from support.editor import Editor


@pytest.fixture(scope="session")
def editor(tmp_path_factory):
    """One editor for all who do not mind what else is open in it."""
    editor = Editor(tmp_path_factory.mktemp("workspace"))
    yield editor
    editor.end()
