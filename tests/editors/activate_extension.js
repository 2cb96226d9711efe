// Activates the bundled extension with a `vscode` in which everything is there and does nothing, but for
// the settings: node activate_extension.js EXTENSION COMMAND. Prints `started`, or what is shown as an error.
"use strict";

const Module = require("module");

const [, , extension, command] = process.argv;

function anything() {
  const settled = function () {};
  return new Proxy(settled, {
    get: (target, name) => {
      if (name === Symbol.iterator) return [][Symbol.iterator];
      if (name === Symbol.toPrimitive) return () => "";
      if (name === "then") return undefined;
      if (name === "prototype") return target.prototype;
      if (!(name in target)) target[name] = anything();
      return target[name];
    },
    apply: () => anything(),
    construct: () => anything(),
  });
}

const vscode = anything();
vscode.version = "1.91.0";
vscode.workspace = anything();
vscode.workspace.workspaceFolders = undefined;
vscode.workspace.textDocuments = [];
vscode.workspace.getConfiguration = () => ({ get: (name) => (name === "command" ? [command] : undefined) });
vscode.env = anything();
vscode.env.appName = "test";
vscode.env.language = "en";
vscode.window = anything();
vscode.window.showErrorMessage = async (message) => {
  console.log(message);
  return "shown";
};

const load = Module._load;
Module._load = (name, ...rest) => (name === "vscode" ? vscode : load(name, ...rest));

const { activate } = require(extension);
activate({ subscriptions: [] }).then((problem) => {
  if (problem !== "shown") console.log("started");
  process.exit(0);
});
