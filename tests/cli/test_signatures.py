"""``--require-signed``: compiled rulebooks that a key has signed, and no others.

The key and the signatures are made here as minisign's page describes them, and by minisign itself
where it is installed.
"""

import base64
import shutil
import subprocess
from hashlib import blake2b

import pytest
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

from rulec.automata.bundle import required_signature
from rulec.cli.main import main

NUMBER = b"numbered"
SECRET = Ed25519PrivateKey.from_private_bytes(bytes(range(32)))
OTHER = Ed25519PrivateKey.from_private_bytes(bytes(32))


def base64_of(*parts):
    return base64.b64encode(b"".join(parts)).decode()


def key_text(secret=SECRET, number=NUMBER):
    return base64_of(b"Ed", number, secret.public_key().public_bytes_raw())


def signature_text(data, secret=SECRET, number=NUMBER, kind=b"ED", comment="today"):
    signature = secret.sign(blake2b(data).digest() if kind == b"ED" else data)
    of_comment = secret.sign(signature + comment.encode())
    return (
        f"untrusted comment: whatever\n{base64_of(kind, number, signature)}\n"
        f"trusted comment: {comment}\n{base64_of(of_comment)}\n"
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("build")
    assert main(["compile", "esterle2019", "-o", str(folder)]) == 0
    (folder / "key.pub").write_text(f"untrusted comment: a key\n{key_text()}\n")
    return folder


@pytest.fixture
def rules(folder):
    path = folder / "esterle2019.json"
    path.with_name("esterle2019.json.minisig").write_text(signature_text(path.read_bytes()))
    return path


def asked(rules, key, capsys):
    capsys.readouterr()
    status = main(["show", str(rules), "R1", "--require-signed", str(key)])
    return status, capsys.readouterr().err


def test_what_is_signed_is_taken(folder, rules, capsys):
    assert asked(rules, folder / "key.pub", capsys) == (0, "")
    assert asked(rules, key_text(), capsys) == (0, "")


def test_nothing_is_required_afterwards(folder, rules, capsys):
    asked(rules, folder / "key.pub", capsys)
    rules.with_name("esterle2019.json.minisig").unlink()
    assert main(["show", str(rules), "R1"]) == 0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, "no signature beside"),
        (lambda data: signature_text(data, OTHER), "not signed by the required key"),
        (lambda data: signature_text(data, number=b"anothern"), "not signed by the required key"),
        (lambda data: signature_text(data + b" "), "not signed by the required key"),
        (lambda data: signature_text(data, kind=b"Ed"), "without `-l`"),
        (
            lambda data: signature_text(data).replace("today", "to-day"),
            "not signed by the required key",
        ),
        (lambda data: signature_text(data).replace("today", "today\n"), "four lines"),
        (lambda data: signature_text(data)[:-9], "is not a signature"),
        (lambda data: "\n\n\n\n", "four lines"),
        (lambda data: "\ufffd" * 9, "is not a signature"),
    ],
)
def test_what_is_not_signed_is_refused(folder, rules, text, words, capsys):
    beside = rules.with_name("esterle2019.json.minisig")
    beside.unlink()
    if text is not None:
        beside.write_text(text(rules.read_bytes()))
    status, err = asked(rules, folder / "key.pub", capsys)
    assert status == 2
    assert "R0412" in err
    assert words in err


@pytest.mark.parametrize(
    "key", ["", "nowhere.pub", "RWQ", key_text()[:-4], base64_of(b"ED", b"8" * 40)]
)
def test_what_is_no_key_is_refused(rules, key, capsys, tmp_path):
    (tmp_path / "key.pub").write_text(key)
    status, err = asked(rules, tmp_path / "key.pub", capsys)
    assert status == 2
    assert "R0413" in err


@pytest.mark.parametrize(
    "arguments",
    [
        ["show", "esterle2019"],
        ["verify", "traces.jsonl", "-r", "esterle2019"],
        ["maneuvers", "s1", "-r", "esterle2019"],
        ["draw", "scene", "s1", "-r", "esterle2019", "-o", "s1.svg"],
        ["maneuvers", "--envelopes", "s1", "-r", "esterle2019", "-o", "s1.csv"],
        ["monitor", "esterle2019"],
    ],
)
def test_a_source_is_never_signed(arguments, folder, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "traces.jsonl").write_text('{"states": [{}]}\n')
    assert main([*arguments, "--require-signed", str(folder / "key.pub")]) == 2
    assert "R0412" in capsys.readouterr().err


def test_without_cryptography_it_says_what_is_missing(folder, rules, capsys, monkeypatch):
    def missing(*_):
        raise ImportError

    monkeypatch.setattr("rulec.automata.bundle.required_signature.has_signed", missing)
    status, err = asked(rules, folder / "key.pub", capsys)
    assert status == 2
    assert "R0414" in err
    assert "[signed]'`" in err


# Made by minisign 0.11: `minisign -G -W`, and `minisign -S -m hello -t 'de, 2026'`.
KEY = "RWQkF88c9hIe+Ip+cBE8srVQ+AZLA9rUsl5RNpje9LC8FABS7WICckWL"
SIGNATURE = """\
untrusted comment: signature from minisign secret key
RUQkF88c9hIe+GOqaA8LV78l3ZodSHh462WxEXCczDWnNI/q+goWLs9swSxloWlRFS0SJj27BcpgIUvJULArxnPvcWbj39sS2Ao=
trusted comment: de, 2026
VZuMb860k/Natq0GPn9fORG1BQNtNUv7QE0LLR3PLp3N5JYMLV9r0v/aJWH/7pDMaKnBQno+0grGxtTsl+0RCQ==
"""


def test_what_minisign_has_signed():
    key, signature = (
        required_signature.public_key(KEY),
        required_signature.detached_signature(SIGNATURE),
    )
    assert required_signature.has_signed(key, signature, b"hello\n")
    assert not required_signature.has_signed(key, signature, b"hello")
    assert signature.comment == "de, 2026"


@pytest.mark.skipif(shutil.which("minisign") is None, reason="minisign is not installed")
def test_what_minisign_signs_here(rules, capsys, tmp_path):
    own = ["-s", str(tmp_path / "secret")]
    public = str(tmp_path / "own.pub")
    subprocess.run(["minisign", "-G", "-W", "-p", public, *own], check=True, capture_output=True)
    sign = ["minisign", "-S", *own, "-m", str(rules)]
    subprocess.run(sign, check=True, capture_output=True)
    assert asked(rules, public, capsys) == (0, "")
    subprocess.run([*sign, "-l"], check=True, capture_output=True)
    assert asked(rules, public, capsys)[0] == 2


def test_a_key_file_that_is_not_there_is_named(capsys):
    assert main(["show", "esterle2019", "--require-signed", "keys/us.pub"]) == 2
    err = capsys.readouterr().err
    assert "error[R0413]: there is no such file\n --> keys/us.pub\n" in err
