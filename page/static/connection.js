// The line to `foxhunt live`: it opens itself again when it was lost.

const RETRY_MS = 2000;

// The state that the server has; `null` if it has none, so that the page is on its own.
export async function fetchState() {
  try {
    const response = await fetch("api/state", { cache: "no-store" });
    if (!response.ok) return null;
    return await response.json();
  } catch {
    return null;
  }
}

export async function post(path, body = {}) {
  try {
    const response = await fetch(`api/${path}`, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(body),
    });
    if (response.ok) return null;
    const answer = await response.json().catch(() => ({}));
    return answer.error ?? `the server says ${response.status}`;
  } catch {
    return "the server does not answer";
  }
}

// A line that is opened while the page loads would have the browser say for ever that it loads.
const loaded = new Promise((resolve) => {
  if (document.readyState === "complete") resolve();
  else addEventListener("load", () => setTimeout(resolve), { once: true });
});

// Calls `take(messages, isAnew)` with what has come, and `tell(isOpen)` when the line opens or is lost.
export class Connection {
  constructor(state, { take, tell }) {
    Object.assign(this, { take, tell });
    this.#begin(state);
  }

  #begin(state) {
    this.take(state.messages, true);
    loaded.then(() => this.#listen(state));
  }

  #listen(state) {
    this.events = new EventSource(`api/events?after=${state.seq}`);
    this.events.addEventListener("open", () => this.tell(true));
    this.events.addEventListener("message", (event) => this.take([JSON.parse(event.data)], false));
    this.events.addEventListener("error", () => {
      this.tell(false);
      // A server that was started anew counts from the beginning: what it knows is fetched anew.
      this.events.close();
      setTimeout(() => this.#again(), RETRY_MS);
    });
  }

  async #again() {
    const state = await fetchState();
    if (state) this.#begin(state);
    else setTimeout(() => this.#again(), RETRY_MS);
  }
}
