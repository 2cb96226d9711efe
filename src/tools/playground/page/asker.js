// Asks rulec in a worker: one question after another, only the latest of each kind.

export class Asker {
  /** `onState` is called with the state: "starting", "asking" with the question, "ready", "broken". */
  constructor(onState) {
    this.onState = onState;
    this.waiting = new Map();
    this.number = 0;
    this.current = null;
    this.start();
  }

  start() {
    this.isReady = false;
    this.onState("starting");
    this.worker = new Worker("worker.js", { type: "module" });
    this.worker.onmessage = ({ data }) => this.heard(data);
    this.worker.onerror = (event) => this.heard({ broken: event.message || "it cannot be loaded" });
  }

  /** The answer; undefined if it was stopped, or replaced by a newer question of its kind. */
  ask(question, onProgress = () => {}) {
    return new Promise((resolve) => {
      this.waiting.get(question.ask)?.resolve(undefined);
      this.waiting.delete(question.ask);
      this.waiting.set(question.ask, { question, resolve, onProgress });
      this.next();
    });
  }

  /** Stop the current question and drop the waiting ones. */
  stop() {
    this.worker.terminate();
    for (const { resolve } of [this.current, ...this.waiting.values()].filter(Boolean)) resolve();
    this.current = null;
    this.waiting.clear();
    this.start();
  }

  next() {
    if (!this.isReady || this.current) return;
    // Checks of the text being typed have priority over longer questions.
    const kind = this.waiting.has("check") ? "check" : this.waiting.keys().next().value;
    if (kind === undefined) {
      this.onState("ready");
      return;
    }
    this.current = this.waiting.get(kind);
    this.waiting.delete(kind);
    this.onState("asking", this.current.question);
    this.worker.postMessage(JSON.stringify(this.current.question));
  }

  heard({ ready, progress, answer, broken }) {
    if (broken !== undefined) {
      this.worker.terminate();
      const { current } = this;
      this.current = null;
      if (current === null) {
        this.onState("broken", broken);
        return;
      }
      current.resolve({ failure: broken });
      this.start();
    } else if (progress !== undefined) {
      this.current?.onProgress(progress);
    } else if (ready) {
      this.isReady = true;
      this.next();
    } else {
      const { resolve } = this.current;
      this.current = null;
      resolve(JSON.parse(answer));
      this.next();
    }
  }
}
