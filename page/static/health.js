// Which inputs and outputs work, and what became of what came in.

import { make } from "./dom.js";
import { clock, seconds } from "./words.js";

const SIGNS = { open: "●", silent: "◐", lost: "○", ended: "■" };

export function healthPanel({ inputs, outputs }, refused) {
  return make("section", { id: "health" },
    make("h2", {}, "Inputs"),
    inputs.length > 0
      ? make("ul", { className: "list" }, inputs.map(inputItem))
      : make("p", { className: "faint" }, "Nothing was heard of yet."),
    refused.length > 0 ? make("h2", {}, "Not used lately") : null,
    refused.length > 0 ? make("ul", { className: "list", id: "refused" }, refused.toReversed().map(refusedItem)) : null,
    outputs.length > 0 ? make("h2", {}, "Outputs") : null,
    outputs.length > 0 ? make("ul", { className: "list" }, outputs.map(outputItem)) : null,
  );
}

function inputItem({ name, state, since_ms, lines = 0, used = 0, refused = {} }) {
  const isOpen = state === "open";
  const since = !isOpen && since_ms ? ` for ${seconds(Math.max(0, Date.now() - since_ms) / 1000)}` : "";
  const reasons = Object.entries(refused).filter(([, count]) => count > 0);
  const why = reasons.map(([reason, count]) => `${count} × ${reason}`).join("; ");
  return make("li", {},
    stateLine(name, state, since),
    make("div", { className: "faint" }, `${lines} lines, ${used} used`),
    why ? make("div", { className: "faint" }, `Not used: ${why}`) : null,
  );
}

function refusedItem({ input, reason, text, time_ms }) {
  const when = time_ms > 0 ? `${clock(time_ms)}, ` : "";
  return make("li", {},
    `${when}${input}: ${reason}`,
    make("div", { className: "faint" }, text),
  );
}

function outputItem({ name, state, queued = 0, sent = 0, lost = 0 }) {
  const losses = lost > 0 ? `, ${lost} lost` : "";
  return make("li", {},
    stateLine(name, state, ""),
    make("div", { className: "faint" }, `${sent} sent, ${queued} waiting${losses}`),
  );
}

function stateLine(name, state, since) {
  // What has come to its end, as a file does, is as it should be.
  const className = { open: "good", ended: "" }[state] ?? "bad";
  return make("b", { className }, `${SIGNS[state] ?? "○"} ${name}: ${state}${since}`);
}
