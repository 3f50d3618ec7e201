// Elements of the page, made from plain values.

// An element with properties and children; `null` children are left out.
export function make(name, properties = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (value == null) continue;
    if (key in element) element[key] = value;
    else element.setAttribute(key, value);
  }
  element.append(...children.flat().filter((child) => child != null));
  return element;
}

export function button(text, act, properties = {}) {
  return make("button", { type: "button", onclick: act, ...properties }, text);
}

// A labelled choice: `choices` are [value, text].
export function choice(text, choices, value, changed) {
  const options = choices.map(([name, words]) => make("option", { value: name, selected: name === value }, words));
  const select = make("select", { onchange: () => changed(select.value) }, options);
  return make("label", {}, text, select);
}

// A labelled number.
export function number(text, { value, min, max, step = 1 }, changed) {
  const input = make("input", { type: "number", value, min, max, step, inputMode: "decimal" });
  input.addEventListener("change", () => {
    const entered = Number(input.value);
    const kept = Number.isFinite(entered) ? Math.min(Math.max(entered, min), max) : value;
    input.value = kept;
    changed(kept);
  });
  return make("label", {}, text, input);
}

export function check(text, checked, changed) {
  const input = make("input", { type: "checkbox", checked, onchange: () => changed(input.checked) });
  return make("label", {}, text, input);
}

// Names and values, one below the other; those without a value are left out.
export function table(rows) {
  const known = rows.filter(([, value]) => value != null);
  return make("dl", {}, known.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]));
}
