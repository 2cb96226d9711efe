// Python with rulec: questions and answers are JSON.

import { loadPyodide } from "./pyodide/pyodide.mjs";

async function fetched(path) {
  const response = await fetch(path);
  if (!response.ok) throw new Error(`${path}: ${response.status} ${response.statusText}`);
  return response;
}

async function started() {
  const parts = (await fetched("playground.json")).json();
  const python = await loadPyodide({ indexURL: new URL("pyodide/", self.location).href });
  const site = python.runPython("import site; site.getsitepackages()[0]");
  const archives = ["libraries.zip", ...(await parts).wheels];
  const contents = await Promise.all(
    archives.map(async (name) => (await fetched(`python/${name}`)).arrayBuffer()),
  );
  for (const content of contents) python.unpackArchive(content, "zip", { extractDir: site });
  const questions = await (await fetched("python/questions.py")).text();
  python.FS.writeFile(`${site}/questions.py`, questions);
  python.runPython("import os; os.makedirs('/desk'); os.chdir('/desk')");
  return python.pyimport("questions").answer;
}

const told = (progress) => self.postMessage({ progress });

// After a fatal error the page starts a new worker.
const answer = await started().catch((error) => {
  self.postMessage({ broken: String(error.message).trim().split("\n").at(-1) });
});

self.onmessage = ({ data }) => {
  try {
    self.postMessage({ answer: answer(data, told) });
  } catch (error) {
    self.postMessage({ broken: String(error.message).trim().split("\n").at(-1) });
  }
};
if (answer) self.postMessage({ ready: true });
