// What the messages of `foxhunt live` add up to.

import { Plane } from "./geo.js";

const MOST_TRACK = 5000;
const TRACK_STEP_M = 2;
const MOST_REFUSED = 3;

export class Store {
  constructor() {
    this.plane = null;
    this.receivers = new Map();
    this.bearings = new Map();
    this.marks = new Map();
    this.tags = new Map();
    this.tracks = new Map();
    this.answer = null;
    this.site = null;
    this.health = { inputs: [], outputs: [] };
    this.refused = [];
    this.time_ms = 0;
  }

  apply(message) {
    if (message.time_ms > this.time_ms) this.time_ms = message.time_ms;
    this[`on_${message.type}`]?.(message);
  }

  on_receiver(message) {
    const before = this.receivers.get(message.name);
    const receiver = { ...before, ...message };
    this.receivers.set(message.name, receiver);
    if (receiver.lat == null) return;
    [receiver.x, receiver.y] = this.#metres(receiver.lat, receiver.lon);
    if (receiver.kind === "vehicle") this.#pass(receiver);
  }

  on_bearing(message) {
    const [x, y] = this.#metres(message.lat, message.lon);
    const isNew = !this.bearings.has(message.id);
    this.bearings.set(message.id, { ...this.bearings.get(message.id), ...message, x, y });
    // After a reload, bearings are all that tells where the vehicle has been.
    if (isNew) this.#pass({ name: `bearings of ${message.receiver}`, x, y });
  }

  on_retracted({ id, by }) {
    const bearing = this.bearings.get(id);
    if (bearing) Object.assign(bearing, { retracted: true, by });
  }

  on_restored({ id }) {
    const bearing = this.bearings.get(id);
    if (bearing) bearing.retracted = false;
  }

  on_answer(message) {
    const locate = (place) => {
      const [x, y] = this.#metres(place.lat, place.lon);
      return { ...place, x, y };
    };
    const particles = (message.particles ?? []).flatMap(([lat, lon]) => [...this.#metres(lat, lon), 1]);
    const sources = (message.sources ?? []).map(locate);
    this.answer = {
      ...message,
      sources: sources.filter((source) => source.fix !== false),
      hypotheses: (message.hypotheses ?? []).map(locate),
      advice: message.advice && locate(message.advice),
      particles,
    };
  }

  on_tag(message) {
    const key = `${message.site} ${message.id}`;
    const tag = { ...message, state: message.state?.toLowerCase() };
    if (tag.covariance) tag.ellipse = ellipseOf(tag.covariance);
    this.tags.set(key, tag);
  }

  on_site(message) {
    this.site = message;
  }

  on_health({ inputs, outputs }) {
    this.health = { inputs: inputs ?? [], outputs: outputs ?? [] };
  }

  on_refused(message) {
    this.refused = [...this.refused, message].slice(-MOST_REFUSED);
  }

  on_outliers({ changed }) {
    for (const [id, outlier] of changed) {
      const bearing = this.bearings.get(id);
      if (bearing) bearing.outlier = outlier;
    }
  }

  on_mark(message) {
    if (message.removed) {
      this.marks.delete(message.id);
      return;
    }
    const [x, y] = this.#metres(message.lat, message.lon);
    this.marks.set(message.id, { ...message, x, y });
  }

  // The first place of all is the origin.
  #metres(lat, lon) {
    this.plane ??= new Plane([lat, lon]);
    return this.plane.metres(lat, lon);
  }

  #pass({ name, x, y }) {
    const track = this.tracks.get(name) ?? [];
    const last = track.at(-1);
    if (last && Math.hypot(last[0] - x, last[1] - y) < TRACK_STEP_M) return;
    track.push([x, y]);
    if (track.length > MOST_TRACK) track.shift();
    this.tracks.set(name, track);
  }
}

// What holds 95 % of a normal distribution, whose axes are those of x and y.
export function ellipseOf([xx, xy, yy]) {
  const middle = (xx + yy) / 2;
  const apart = Math.hypot((xx - yy) / 2, xy);
  const radius = Math.sqrt(-2 * Math.log(0.05));
  const angle = (0.5 * Math.atan2(2 * xy, xx - yy) * 180) / Math.PI;
  return {
    semi_major_m: radius * Math.sqrt(middle + apart),
    semi_minor_m: radius * Math.sqrt(Math.max(middle - apart, 0)),
    angle_deg: 90 - angle,
  };
}
