// Starts rulec's language server for open rulebooks. All language features are in `rulec lsp`.
"use strict";

const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

function start() {
  const command = vscode.workspace.getConfiguration("rulec").get("command");
  const [program, ...before] = command;
  client = new LanguageClient(
    "rulec",
    "rulec",
    { command: program, args: [...before, "lsp"] },
    { documentSelector: [{ language: "rulec" }] },
  );
  return client.start().catch(() =>
    vscode.window.showErrorMessage(
      `rulec: \`${command.join(" ")} lsp\` does not start. ` +
        "In rulec's checkout `.venv/bin/python -m pip install -e '.[lsp]'` installs it; " +
        "set `rulec.command` to its path.",
    ),
  );
}

async function stop() {
  const running = client;
  client = undefined;
  if (running?.isRunning()) await running.stop();
}

exports.activate = (context) => {
  const restart = async () => {
    await stop();
    await start();
  };
  context.subscriptions.push(vscode.commands.registerCommand("rulec.restart", restart));
  return start();
};

exports.deactivate = stop;
