// The library as WebAssembly: text and bytes in, states out.

let compiled;

// One instance holds one hunt, one log and one walk.
export async function engine() {
  compiled ??= WebAssembly.compileStreaming(fetch("foxhunt.wasm"));
  const { exports } = await WebAssembly.instantiate(await compiled, {});
  return new Engine(exports);
}

class Engine {
  constructor(exports) {
    this.exports = exports;
  }

  startHunt(options) {
    return this.#call("hunt_start", options);
  }

  seekHunt(position) {
    return this.#call("hunt_seek", null, position);
  }

  startLog(options) {
    return this.#call("log_start", options);
  }

  pushLog(bytes) {
    this.#fill(bytes);
    return this.#call("log_push");
  }

  startWalkers(options) {
    return this.#call("walkers_start", options);
  }

  seekWalkers(milliseconds) {
    return this.#call("walkers_seek", null, milliseconds);
  }

  // The answer as the text that it is; whatever is shown is read from it.
  get text() {
    return this.lastText;
  }

  #fill(bytes) {
    const at = this.exports.input(bytes.length);
    new Uint8Array(this.exports.memory.buffer, at, bytes.length).set(bytes);
  }

  #call(name, options, ...numbers) {
    if (options) this.#fill(new TextEncoder().encode(JSON.stringify(options)));
    const length = this.exports[name](...numbers);
    const bytes = new Uint8Array(this.exports.memory.buffer, this.exports.output(), length);
    this.lastText = new TextDecoder().decode(bytes);
    const answer = length ? JSON.parse(this.lastText) : {};
    if (answer.error) throw new Error(answer.error);
    return answer;
  }
}
