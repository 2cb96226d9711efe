"""A folder with a rulebook, what it extends and its vocabulary, to be changed by tests."""


def project_in(tmp_path, monkeypatch, **texts):
    """A folder with these files (name -> text), in which the test runs; with a cache of its own."""
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "cache"))
    project = tmp_path / "project"
    project.mkdir()
    monkeypatch.chdir(project)
    for name, text in texts.items():
        (project / f"{name}.rules").write_text(text)
    return project
