// The core for the page: one request at a time, then the newest of those that wait.

// [ms] Time that a newer request waits for a run, or for trials, before these are given up.
const PATIENCE = { run: 3000, trials: 60 };

class Core {
  constructor(module, source) {
    this.module = module;
    this.source = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    this.start();
  }

  start() {
    this.worker = new Worker(this.source);
    this.worker.postMessage({ module: this.module });
    this.worker.onmessage = ({ data }) => this.take(data);
    this.busy = null;
  }

  // Takes a request as JSON; resolves with the answer, or with nothing if a newer request replaced it.
  ask(request, what = "run") {
    return new Promise((resolve) => {
      this.waiting?.resolve(null);
      this.waiting = { request, resolve, what };
      if (!this.busy) this.send();
      else setTimeout((busy) => this.giveUp(busy), PATIENCE[this.busy.what], this.busy);
    });
  }

  send() {
    this.busy = this.waiting;
    this.waiting = null;
    if (this.busy) this.worker.postMessage({ request: this.busy.request });
  }

  giveUp(busy) {
    if (this.busy !== busy || !this.waiting) return;
    this.worker.terminate();
    busy.resolve(null);
    this.start();
    this.send();
  }

  take({ text, numbers }) {
    const { resolve } = this.busy;
    const answer = JSON.parse(text, (_, value) =>
      (value?.first === undefined ? value : numbers.subarray(value.first, value.first + value.count)));
    resolve(answer);
    this.send();
  }
}

// The module, which the page contains as gzipped bytes in base 64.
async function compiled(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length); // a loop, because `Uint8Array.from` takes a quarter of a second
  for (let i = 0; i < bytes.length; i++) bytes[i] = letters.charCodeAt(i);
  const unzipped = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(unzipped).arrayBuffer());
}
