"""The protocol, with a reply to each request, also to those that no server can answer."""

from __future__ import annotations

import logging
from typing import Any

from lsprotocol import types as lsp
from pygls.exceptions import (
    JsonRpcException,
    JsonRpcInvalidRequest,
    JsonRpcServerNotInitialized,
)
from pygls.protocol import LanguageServerProtocol


def _is_no_refusal(record: logging.LogRecord) -> bool:
    """Tell whether a record is about more than a refusal, which its reply explains."""
    return not (record.exc_info and isinstance(record.exc_info[1], JsonRpcException))


# An editor shows as a crash of the server what pygls logs of each: a name that cannot be, say.
logging.getLogger("pygls.protocol.json_rpc").addFilter(_is_no_refusal)


class StrictProtocol(LanguageServerProtocol):
    """Where pygls reports an error to whoever looks, the client that waits is told, too."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        """A message as an object; what holds one is answered if it cannot be."""
        try:
            return super().structure_message(data)
        except JsonRpcException as problem:
            if "id" in data and "method" in data:
                self.refuse(data["id"], problem)
            raise

    def handle_message(self, message: Any) -> None:
        """Answer a message, or refuse it: no message, too early, or too late."""
        number, method = (getattr(message, name, None) for name in ("id", "method"))
        is_begun = self._workspace is not None or method in (lsp.INITIALIZE, lsp.EXIT)
        if getattr(message, "jsonrpc", "") != self.VERSION:
            number = message.get("id") if isinstance(message, dict) else number
            self.refuse(number, JsonRpcInvalidRequest("this is no message of JSON-RPC 2.0"))
        elif is_begun and not (self._shutdown and method and number is not None):
            super().handle_message(message)
        elif number is not None and is_begun:
            self.refuse(number, JsonRpcInvalidRequest("the server has been shut down"))
        elif number is not None:
            self.refuse(number, JsonRpcServerNotInitialized())

    def refuse(self, number: Any, problem: JsonRpcException) -> None:
        """Reply with an error, also to what has no number."""
        error = {"code": problem.code, "message": problem.message}
        self._send_data({"jsonrpc": self.VERSION, "id": number, "error": error})
