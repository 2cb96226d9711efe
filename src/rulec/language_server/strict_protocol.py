"""The protocol with a reply to every request, including invalid ones."""

from __future__ import annotations

import logging
from typing import Any

from lsprotocol import types as lsp
from pygls.exceptions import (
    JsonRpcException,
    JsonRpcInvalidParams,
    JsonRpcInvalidRequest,
    JsonRpcServerNotInitialized,
)
from pygls.protocol import LanguageServerProtocol

UNREADABLE = (ValueError, RecursionError)
"""What reading a message raises that is not JSON, or is nested too deeply."""


def _is_no_refusal(record: logging.LogRecord) -> bool:
    """Whether a log record is about more than a refusal, which its reply explains already.

    Of a message whose parts do not fit its method, and of a reply that cannot be written, a line
    stays, and not the traceback below it.
    """
    record.msg, record.args = record.getMessage().partition("\n")[0], ()
    problem = record.exc_info[1] if record.exc_info else None
    if isinstance(problem, OSError) and record.msg.startswith("Error sending data"):
        record.exc_info = None
    kinds = (JsonRpcException, *(UNREADABLE if record.name == "pygls.server" else ()))
    return not isinstance(problem, kinds)


# Editors show each error logged by pygls as a crash of the server, even for an invalid new name.
for _logger in ("pygls.protocol.json_rpc", "pygls.server"):
    logging.getLogger(_logger).addFilter(_is_no_refusal)


_TAKEN = "a command takes two texts: a document's address and a rule's name"


def _names_a_rule(message: Any) -> bool:
    """Whether a command has its arguments, without which pygls would call it all the same."""
    arguments = getattr(getattr(message, "params", None), "arguments", None) or ()
    return len(arguments) == 2 and all(isinstance(one, str) for one in arguments)


class StrictProtocol(LanguageServerProtocol):
    """Sends an error to the waiting client where pygls would only log it."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        """A message as an object; an invalid request is refused."""
        try:
            return super().structure_message(data)
        except JsonRpcException as problem:
            if "id" in data and "method" in data:
                self.refuse(data["id"], problem)
            raise

    def handle_message(self, message: Any) -> None:
        """Answer a message, or refuse it: invalid, too early, or too late."""
        number, method = (getattr(message, name, None) for name in ("id", "method"))
        is_begun = self._workspace is not None or method in (lsp.INITIALIZE, lsp.EXIT)
        if getattr(message, "jsonrpc", "") != self.VERSION:
            number = message.get("id") if isinstance(message, dict) else number
            self.refuse(number, JsonRpcInvalidRequest("this is no message of JSON-RPC 2.0"))
        elif method == lsp.INITIALIZE and self._workspace is not None:
            # pygls would begin anew, without the documents that are open.
            self.refuse(number, JsonRpcInvalidRequest("the server has been initialized already"))
        elif is_begun and method == lsp.WORKSPACE_EXECUTE_COMMAND and not _names_a_rule(message):
            self.refuse(number, JsonRpcInvalidParams(_TAKEN))
        elif is_begun and not (self._shutdown and method and number is not None):
            super().handle_message(message)
        elif number is not None and is_begun:
            self.refuse(number, JsonRpcInvalidRequest("the server has been shut down"))
        elif number is not None:
            self.refuse(number, JsonRpcServerNotInitialized())

    def refuse(self, number: Any, problem: JsonRpcException) -> None:
        """Reply with an error, also to a message without a number."""
        error = {"code": problem.code, "message": problem.message}
        self._send_data({"jsonrpc": self.VERSION, "id": number, "error": error})
