"""What the protocol asks of a server whatever is sent: a reply to each request, and an end."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

HOVER = "textDocument/hover"
COMMAND = "workspace/executeCommand"
SOMEWHERE = {"textDocument": {"uri": "file:///a.rules"}, "position": {"line": 0, "character": 0}}
BEGINNING = {"processId": None, "rootUri": None, "capabilities": {}}


class Wire:
    """A server's standard input and output."""

    def __init__(self, *, begun=True, stderr=subprocess.DEVNULL):
        command = [sys.executable, "-m", "rulec", "lsp"]
        pipe = subprocess.PIPE
        self.server = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=stderr)
        if begun:
            assert "result" in self.ask(0, "initialize", BEGINNING)

    def ask(self, number, method, params):
        return self.reply(message(id=number, method=method, params=params))

    def say(self, text):
        body = text.encode()
        self.server.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self.server.stdin.flush()

    def reply(self, text):
        self.say(text)
        return self.heard()

    def heard(self):
        length = 0
        while (line := self.server.stdout.readline()) != b"\r\n":
            name, _, value = line.partition(b":")
            length = int(value) if name == b"Content-Length" else length
        return json.loads(self.server.stdout.read(length))


def message(**parts):
    return json.dumps({"jsonrpc": "2.0", **parts})


@pytest.fixture
def wire():
    made = []

    def begin(**how):
        made.append(Wire(**how))
        return made[-1]

    yield begin
    for one in made:
        one.server.kill()
        one.server.communicate()


REFUSED = [
    (message(id=1, method=HOVER, params={"textDocument": 3}), 1, -32602),
    (message(id="a", method=HOVER), "a", -32602),
    (message(id=1, method="rulec/nothing", params={}), 1, -32601),
    (message(id=5, method=COMMAND, params={"command": "rulec.runExamples"}), 5, -32602),
    (
        message(id=6, method=COMMAND, params={"command": "rulec.inEnglish", "arguments": [1, 2]}),
        6,
        -32602,
    ),
    (message(id=7, method=COMMAND, params={"command": "nothing"}), 7, -32602),
    ("{abc}", None, -32700),
    ("[" * 100_000, None, -32700),
    (message(id=8, method="initialize", params=BEGINNING), 8, -32600),
    ("[]", None, -32600),
    ("3", None, -32600),
    (json.dumps({"id": 4, "method": HOVER, "params": SOMEWHERE}), 4, -32600),
]


def test_what_cannot_be_answered_is_refused_and_the_next_is_answered(wire):
    """All of it is asked of one server."""
    server = wire(stderr=subprocess.PIPE)
    for text, number, code in REFUSED:
        refused = server.reply(text)
        assert (refused["id"], refused["error"]["code"]) == (number, code), text[:200]
        answered = server.ask(9, HOVER, SOMEWHERE)
        assert answered == {"jsonrpc": "2.0", "id": 9, "result": None}, text[:200]
    server.server.kill()
    assert b"Traceback" not in server.server.communicate()[1]


def test_a_second_beginning_leaves_open_what_was(wire, tmp_path):
    server = wire()
    document = {"uri": (tmp_path / "a.rules").as_uri()}
    text = "rulebook a\nsignal p\nhard rule r { require always p }\n"
    opened = {**document, "languageId": "rulec", "version": 1, "text": text}
    server.say(message(method="textDocument/didOpen", params={"textDocument": opened}))
    assert server.heard()["params"]["version"] == 1
    assert server.ask(1, "initialize", BEGINNING)["error"]["code"] == -32600
    changed = {
        "textDocument": {**document, "version": 2},
        "contentChanges": [{"text": text + "signal q\n"}],
    }
    server.say(message(method="textDocument/didChange", params=changed))
    assert server.heard()["params"]["version"] == 2


def test_an_editor_is_asked_for_nothing_that_it_cannot_do(wire, tmp_path):
    server = wire()
    document = {"uri": (tmp_path / "a.rules").as_uri()}
    text = "rulebook a\nsignal p\nhard rule r { require always p accept { p } }\n"
    opened = {**document, "languageId": "rulec", "version": 1, "text": text}
    server.say(message(method="textDocument/didOpen", params={"textDocument": opened}))
    params = {"command": "rulec.insertExample", "arguments": [document["uri"], "r"]}
    heard = [server.ask(1, COMMAND, params)]
    while heard[-1].get("id") != 1:
        heard.append(server.heard())
    assert {one["method"] for one in heard[:-1]} <= {
        "textDocument/publishDiagnostics",
        "window/showMessage",
    }
    shown = [one["params"]["message"] for one in heard if one.get("method") == "window/showMessage"]
    assert shown == [heard[-1]["result"]] == ["reject { not p }"]


def test_requests_have_their_time(wire):
    server = wire(begun=False)
    assert server.ask(1, HOVER, SOMEWHERE)["error"]["code"] == -32002
    assert "result" in server.ask(2, "initialize", BEGINNING)
    assert server.ask(3, "shutdown", None)["result"] is None
    assert server.ask(4, HOVER, SOMEWHERE)["error"]["code"] == -32600
    server.say(message(method="exit"))
    assert server.server.wait(60) == 0


def test_who_exits_without_shutting_down_leaves_in_error(wire):
    server = wire()
    server.say(message(method="exit"))
    assert server.server.wait(60) == 1


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_though_the_editor_still_has_its_input(wire, number):
    server = wire()
    server.server.send_signal(number)
    assert server.server.wait(60) == 128 + number


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device")
def test_replies_that_cannot_be_written_are_said_once_each():
    bodies = [message(id=0, method="initialize", params=BEGINNING).encode(), b"{abc}"]
    given = b"".join(b"Content-Length: %d\r\n\r\n%s" % (len(body), body) for body in bodies)
    with Path("/dev/full").open("wb") as full:
        command = [sys.executable, "-m", "rulec", "lsp"]
        done = subprocess.run(command, input=given, stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 2
    assert b"Traceback" not in done.stderr
    assert done.stderr.count(b"Error sending data\n") == len(bodies)
    assert b"error[R0720]" in done.stderr


def test_a_name_that_cannot_be_is_refused_without_a_traceback(wire, tmp_path):
    session = wire(stderr=subprocess.PIPE)
    document = {"uri": (tmp_path / "a.rules").as_uri()}
    text = "rulebook a\nsignal p\nhard rule r { require always p }\n"
    opened = {**document, "languageId": "rulec", "version": 1, "text": text}
    session.say(message(method="textDocument/didOpen", params={"textDocument": opened}))
    place = {"textDocument": document, "position": {"line": 1, "character": 7}}
    reply = session.ask(1, "textDocument/rename", {**place, "newName": "not"})
    while "id" not in reply:
        reply = session.heard()
    assert reply["error"]["message"] == "`not` is a word of the language"
    session.server.kill()
    assert session.server.communicate()[1] == b""
