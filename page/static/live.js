// The view of what `foxhunt live` takes in.

import { backgroundOf, Tiles } from "./background.js";
import { Connection, fetchState, post } from "./connection.js";
import { button, make } from "./dom.js";
import { extent, ray } from "./draw.js";
import { healthPanel } from "./health.js";
import { Site } from "./site.js";
import { Store } from "./store.js";
import { answerPanel, clock, degrees, legend, place } from "./words.js";

const NEAR_PX = 18;

export class Live {
  title = "Live";

  // `null` if the server has nothing to show.
  static async find(stage) {
    const state = await fetchState();
    return state && new Live(stage, state);
  }

  constructor(stage, state) {
    this.stage = stage;
    this.store = new Store();
    this.site = new Site(stage, this);
    this.modes = [this, this.site];
    this.actions = make("section", {},
      make("div", { className: "row" }, button("Undo", () => this.#post("undo"), { id: "undo", className: "main" })));
    this.legend = legend([
      "Arrowheads: vehicles. Squares: stations.",
      "Thin lines: bearings, the newest with an arrow; tap one to take it back.",
      "Dashed: taken for outliers. Dotted: retracted or not used.",
      "Dots: particles. Cross and ellipse: a fix, and what holds the source with 95 %.",
      "Dashed ellipses with a percentage: places that fit, before there is a fix.",
      "Thick short arrow: where to drive. Pins: marked places.",
    ]);
    this.tools = this.#makeTools();
    this.connection = new Connection(state, {
      take: (messages, isAnew) => this.#take(messages, isAnew),
      tell: (isOpen) => stage.connection(isOpen ? "● live" : "○ connection lost, trying again", isOpen),
    });
    this.#fetchBackground();
  }

  open() {
    this.stage.view.following = true;
    this.stage.render();
    this.fit();
  }

  close() {
    this.tool = null;
    this.tools = this.#makeTools();
  }

  scene() {
    const { store } = this;
    const receivers = [...store.receivers.values()].filter((receiver) => receiver.x != null);
    const { tiles, shapes } = this.#background();
    return {
      ...store.answer,
      tracks: [...store.tracks.values()],
      bearings: [...store.bearings.values()],
      vehicles: receivers.map((receiver) => ({ ...receiver, name: receivers.length > 1 ? receiver.name : null })),
      marks: [...store.marks.values()],
      tags: this.#tagsOnMap(),
      selected: this.selected,
      hasGrid: !tiles,
      background: (context, view) => {
        tiles?.draw(context, view);
        shapes?.(context, view);
      },
    };
  }

  panel() {
    const { store } = this;
    const where = (source) => place(source.lat, source.lon);
    return [
      this.error && make("p", { className: "error", role: "alert" }, this.error),
      answerPanel({ answer: store.answer, bearings: [...store.bearings.values()], where }),
      this.actions,
      healthPanel(store.health, store.refused),
      this.legend,
      this.attribution,
    ];
  }

  tapped(at, pixel) {
    if (this.tool === "mark") {
      this.#mark(at);
      return;
    }
    this.selected = null;
    const mark = this.#markNear(pixel);
    const bearing = mark ? null : this.#bearingNear(pixel);
    if (mark) this.#showMark(mark);
    else if (bearing) this.#showBearing(bearing);
    else this.stage.popup();
    this.stage.render();
  }

  fit() {
    const { store } = this;
    const receivers = [...store.receivers.values()].filter((receiver) => receiver.x != null);
    const sources = (store.answer?.sources ?? []).flatMap(extent);
    const bearings = [...store.bearings.values()].filter((bearing) => !bearing.retracted);
    const places = [...receivers, ...bearings, ...store.marks.values()].map(({ x, y }) => [x, y]);
    this.stage.view.follow([...places, ...sources]);
  }

  #take(messages, isAnew) {
    if (isAnew) {
      Object.assign(this.store, new Store());
      this.shapes = this.tiles = null;
    }
    for (const message of messages) this.store.apply(message);
    this.stage.tabs?.();
    if (!this.modes.includes(this.stage.mode)) return;
    this.stage.render();
    this.stage.mode.fit();
  }

  #makeTools() {
    const isMarking = this.tool === "mark";
    const toggle = () => {
      this.tool = isMarking ? null : "mark";
      this.tools = this.#makeTools();
      this.stage.render();
    };
    const text = isMarking ? "Tap the place" : "Mark a place";
    return [button(text, toggle, { id: "tool-mark", ariaPressed: String(isMarking) })];
  }

  // Tiles and shapes of features, as soon as it is known where the metres count from.
  #background() {
    const { plane } = this.store;
    if (plane && this.map) this.tiles ??= new Tiles(plane, this.map, () => this.stage.view.request());
    if (plane && this.features) this.shapes ??= backgroundOf(this.features, plane);
    return this;
  }

  #tagsOnMap() {
    const { plane, tags } = this.store;
    const placed = [...tags.values()].filter((tag) => tag.lat != null);
    return plane ? placed.map((tag) => {
      const [x, y] = plane.metres(tag.lat, tag.lon);
      return { ...tag, x, y };
    }) : [];
  }

  #bearingNear(pixel) {
    const { view } = this.stage;
    const scene = this.scene();
    const distances = scene.bearings.map((bearing) => [distanceToLine(pixel, ...ray(view, scene, bearing)), bearing]);
    // Of several, the newest.
    const near = distances.filter(([distance]) => distance < NEAR_PX);
    near.sort(([a, one], [b, other]) => a - b || other.time_ms - one.time_ms);
    return near[0]?.[1];
  }

  #markNear([px, py]) {
    return [...this.store.marks.values()].find((mark) => {
      const [x, y] = this.stage.view.at([mark.x, mark.y]);
      return Math.hypot(px - x, py - (y - 12)) < 22;
    });
  }

  #showBearing(bearing) {
    this.selected = bearing.id;
    const retract = button("Retract this bearing", () => {
      this.#post("retract", { id: bearing.id });
      this.#closePopup();
    }, { id: "retract", className: "main" });
    const what = `${degrees(bearing.bearing_deg)} ± ${degrees(bearing.sigma_deg)}`;
    const isThere = bearing.used && !bearing.retracted;
    this.stage.popup(
      make("p", {}, make("b", {}, what), ` by ${bearing.receiver}, ${clock(bearing.time_ms)}. ${became(bearing)}`),
      make("div", { className: "row" }, isThere ? retract : null, button("Close", () => this.#closePopup())),
    );
  }

  #showMark(mark) {
    this.stage.popup(
      make("p", {}, make("b", {}, mark.text), ` at ${place(mark.lat, mark.lon)}`),
      make("div", { className: "row" },
        button("Remove", () => {
          this.#post("mark", { id: mark.id, removed: true });
          this.#closePopup();
        }),
        button("Close", () => this.#closePopup())),
    );
  }

  #mark(at) {
    const [lat, lon] = this.store.plane?.degrees(at) ?? [0, 0];
    const value = `Mark ${this.store.marks.size + 1}`;
    const input = make("input", { type: "text", value, maxLength: 80, ariaLabel: "Text" });
    const save = () => {
      this.#post("mark", { lat, lon, text: input.value });
      this.#closePopup();
    };
    input.addEventListener("keydown", (event) => event.key === "Enter" && save());
    this.stage.popup(
      make("p", {}, place(lat, lon)),
      make("div", { className: "row" },
        input,
        button("Save", save, { id: "save-mark", className: "main" }),
        button("Cancel", () => this.#closePopup())),
    );
    input.select();
    this.tool = null;
    this.tools = this.#makeTools();
    this.stage.render();
  }

  #closePopup() {
    this.selected = null;
    this.stage.popup();
    this.stage.render();
  }

  async #post(path, body) {
    const error = await post(path, body);
    this.error = error && `This was not done: ${error}.`;
    this.stage.render();
  }

  async #fetchBackground() {
    const response = await fetch("api/background.geojson").catch(() => null);
    if (response?.ok) this.features = await response.json().catch(() => null);
    const tiles = await fetch("api/tiles").catch(() => null);
    if (tiles?.ok) this.map = await tiles.json().catch(() => null);
    const whose = this.map?.attribution;
    if (whose) this.attribution = make("p", { id: "attribution" }, `Map: ${textOf(whose)}`);
    this.stage.render();
    this.stage.view.request();
  }
}

// The text of HTML.
function textOf(html) {
  return new DOMParser().parseFromString(html, "text/html").body.textContent;
}

// What became of a bearing.
function became({ retracted, used, outlier = 0, reason = "no reason given" }) {
  if (retracted) return "It was retracted.";
  if (!used) return `Not used: ${reason}.`;
  return `An outlier with ${Math.round(100 * outlier)} %.`;
}

function distanceToLine([px, py], [ax, ay], [bx, by]) {
  const [u, v] = [bx - ax, by - ay];
  const along = Math.min(Math.max(((px - ax) * u + (py - ay) * v) / Math.max(u * u + v * v, 1e-9), 0), 1);
  return Math.hypot(px - ax - along * u, py - ay - along * v);
}
