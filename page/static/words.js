// What is known, in plain words.

import { make, table } from "./dom.js";
import { OUTLIER, sourceName } from "./draw.js";

export function metres(value) {
  if (value == null) return null;
  if (value < 10) return `${value.toFixed(1)} m`;
  if (value < 1000) return `${Math.round(value)} m`;
  return `${(value / 1000).toFixed(value < 10_000 ? 2 : 1)} km`;
}

// Two lengths, with their unit once where it is the same.
function axes(longer, shorter) {
  const [one, other] = [metres(longer), metres(shorter)];
  const isSame = one.split(" ")[1] === other.split(" ")[1];
  return `${isSame ? one.split(" ")[0] : one} × ${other}`.replaceAll(" ", "\u00a0");
}

export function degrees(value, digits = 1) {
  return value == null ? null : `${value.toFixed(digits)}°`;
}

export function seconds(value) {
  if (value < 90) return `${Math.round(value)} s`;
  if (value < 5400) return `${Math.round(value / 60)} min`;
  return `${Math.round(value / 3600)} h`;
}

// The time of day of milliseconds after 1970.
export function clock(milliseconds) {
  return new Date(milliseconds).toISOString().slice(11, 19) + " UTC";
}

// Degrees with the letters of their hemispheres.
export function place(latitude, longitude) {
  const ns = latitude < 0 ? "S" : "N";
  const ew = longitude < 0 ? "W" : "E";
  return `${Math.abs(latitude).toFixed(5)}° ${ns}, ${Math.abs(longitude).toFixed(5)}° ${ew}`;
}

// A headline, why there is no fix, where to drive, and figures. `where` writes a source's place, if that is known.
export function answerPanel({ answer, bearings = [], where = () => null, extra = [] }) {
  const sources = answer?.sources ?? [];
  const parts = [];
  if (sources.length > 0) {
    for (const source of sources) parts.push(...sourceLines(source, sources.length, where(source)));
  } else {
    parts.push(make("p", { className: "headline" }, "No fix yet"));
    parts.push(make("p", { className: "say" }, why(answer?.reason)));
  }
  if (answer?.advice) parts.push(make("p", { className: "say advice" }, answer.advice.text));
  const used = bearings.filter((bearing) => bearing.used !== false && !bearing.retracted);
  const past = used.filter((bearing) => bearing.past).length;
  const outliers = used.filter((bearing) => !bearing.past && (bearing.outlier ?? 0) > OUTLIER).length;
  parts.push(table([
    ["Bearings", String(used.length)],
    ["Taken for outliers", count(outliers)],
    ["Of where a source was", count(past)],
    ["Retracted or not used", count(bearings.length - used.length)],
    ["Array bias", answer?.bias_deg && `${signed(answer.bias_deg[0])}° ± ${answer.bias_deg[1].toFixed(1)}°`],
    ["Outlier rate, learned", answer?.rates && percent(answer.rates[2])],
    ["Mirrored rate, learned", answer?.rates && answer.rates[1] > 0.005 ? percent(answer.rates[1]) : null],
    ["Particles worth", sources[0]?.effective_sample_size?.toFixed(0)],
    ...extra,
  ]));
  return make("section", { id: "answer" }, parts);
}

function sourceLines(source, count, where) {
  const { semi_major_m, semi_minor_m } = source.ellipse;
  const name = count > 1 ? sourceName(source) : "Fix";
  const within = `95 % within ${axes(semi_major_m, semi_minor_m)}`;
  const isSure = source.probability == null || source.probability > 0.995;
  return [
    make("p", { className: "headline fix" }, `${name}: ${within}`),
    where && make("p", { className: "say" }, where),
    isSure ? null : make("p", { className: "say" }, `There is such a source with ${percent(source.probability)}.`),
    source.moving > 0.05 ? make("p", { className: "say" }, `It moves now with ${percent(source.moving)}.`) : null,
  ].filter(Boolean);
}

// Why there is no fix, and what helps.
function why(reason) {
  if (!reason) return "There is no bearing yet.";
  const text = reason.text[0].toUpperCase() + reason.text.slice(1);
  return `${text}. To get a fix, ${reason.help}.`;
}

function percent(value) {
  return `${Math.round(100 * value)} %`;
}

function signed(value) {
  const text = Math.abs(value).toFixed(1);
  const sign = value < 0 ? "−" : "+";
  return Number(text) === 0 ? text : `${sign}${text}`;
}

function count(value) {
  return value > 0 ? String(value) : null;
}

// What the lines and colours of the map mean.
export function legend(entries) {
  return make("details", {},
    make("summary", {}, "What the map shows"),
    make("ul", { className: "list" }, entries.map((entry) => make("li", {}, entry))),
  );
}
