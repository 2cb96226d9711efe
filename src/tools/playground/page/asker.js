// Asks rulec in a worker of its own: one question after another, the last of each kind only.

export class Asker {
  /** `onState` is told what is going on: "starting", "asking" with the question, or "ready". */
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

  /** The answer; undefined if it was stopped, or if a newer question of its kind came first. */
  ask(question, onProgress = () => {}) {
    return new Promise((resolve) => {
      this.waiting.get(question.ask)?.resolve(undefined);
      this.waiting.delete(question.ask);
      this.waiting.set(question.ask, { question, resolve, onProgress });
      this.next();
    });
  }

  /** End whatever is going on, and what waits. */
  stop() {
    this.worker.terminate();
    for (const { resolve } of [this.current, ...this.waiting.values()].filter(Boolean)) resolve();
    this.current = null;
    this.waiting.clear();
    this.start();
  }

  next() {
    if (!this.isReady || this.current) return;
    // Messages on what is being typed come before all that takes longer.
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
