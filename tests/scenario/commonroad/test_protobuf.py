"""CommonRoad's other form, Protocol Buffers, is refused once."""

import pytest

from rulec.cli.main import main


@pytest.mark.parametrize("command", ["verify", "maneuvers"])
def test_protobuf_is_refused_in_one_sentence(command, tmp_path, capsys):
    file = tmp_path / "DEU_Road-1_1_T-1.pb"
    file.write_bytes(b"\x0a\x81\x01\x0a\x19\x0a\x03DEU\xcb\x0a\xe7\x0a")
    assert main([command, str(file), "-r", "de"]) == 2
    text = capsys.readouterr().err
    assert text.count("error[") == 1
    assert "it is Protocol Buffers, which are not read yet" in text
