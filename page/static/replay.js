// A log that was dropped onto the page, through the gateway of a vehicle.

import { button, choice, make } from "./dom.js";
import { extent } from "./draw.js";
import { engine } from "./engine.js";
import { backgroundOf } from "./background.js";
import { Plane } from "./geo.js";
import { answerPanel, legend, place } from "./words.js";

const PIECE = 1 << 15;
const LOCATORS = [["robust", "Several sources, outliers"], ["plain", "One source, clean bearings"]];

export class Replay {
  title = "Log";

  constructor(stage) {
    this.stage = stage;
    this.locator = "robust";
    this.tools = [];
    this.opener = this.#makeOpener();
    this.legend = legend([
      "Thick line: where the vehicle was. Thin lines: bearings.",
      "Dashed: taken for outliers. Dotted: of where a source was before.",
      "Dots: particles. Cross and ellipse: a fix, and what holds the source with 95 %.",
    ]);
  }

  async open() {
    this.engine ??= await engine();
    this.stage.render();
    this.fit();
  }

  close() {}

  // Takes a file: a log, or a background in GeoJSON.
  async take(file) {
    this.error = null;
    try {
      if (/\.(geo)?json$/i.test(file.name)) {
        this.background = JSON.parse(await file.text());
      } else {
        this.bytes = new Uint8Array(await file.arrayBuffer());
        this.name = file.name;
        await this.#run();
      }
    } catch (error) {
      this.#fail(file.name, error);
    }
    this.stage.render();
  }

  // What is shown is what was read until then.
  #fail(name, error) {
    this.isDone = true;
    this.error = `${name} cannot be read: ${error.message}`;
    this.stage.render();
  }

  async #run() {
    this.engine ??= await engine();
    const run = (this.run = Symbol("run"));
    this.isDone = false;
    this.engine.startLog({ robust: this.locator === "robust" });
    this.stage.view.following = true;
    for (let start = 0; start < this.bytes.length || start === 0; start += PIECE) {
      this.state = this.engine.pushLog(this.bytes.subarray(start, start + PIECE));
      this.read = Math.min(start + PIECE, this.bytes.length);
      this.stage.render();
      this.fit();
      await new Promise((resolve) => requestAnimationFrame(resolve));
      if (this.run !== run) return;
    }
    // The last line may lack its end.
    this.state = this.engine.pushLog(new Uint8Array([10]));
    this.isDone = true;
    this.stage.render();
    this.fit();
  }

  scene() {
    const { state } = this;
    if (!state) return {};
    const plane = this.#plane();
    return {
      ...state.answer,
      tracks: [state.track],
      bearings: state.bearings,
      vehicles: vehicleOf(state.track),
      background: plane && this.background && backgroundOf(this.background, plane),
    };
  }

  tapped() {
    return false;
  }

  panel() {
    const { state } = this;
    const name = make("p", { className: "headline" }, this.name ?? "A log from the field");
    const error = this.error && make("p", { className: "error", role: "alert" }, this.error);
    if (!state) return [name, error, this.opener, this.legend];
    const plane = this.#plane();
    const where = (source) => plane && place(...plane.degrees([source.x, source.y]));
    const read = Math.round((100 * this.read) / Math.max(this.bytes.length, 1));
    return [
      name,
      error,
      this.isDone ? null : make("p", { className: "faint" }, `${read} % read`),
      answerPanel({ answer: state.answer, bearings: state.bearings, where, extra: [["Lines", String(state.lines)]] }),
      refusedPanel(state.refused),
      this.opener,
      this.legend,
    ];
  }

  #makeOpener() {
    const input = make("input", { type: "file", hidden: true });
    input.addEventListener("change", () => input.files[0] && this.take(input.files[0]));
    return make("section", {},
      make("p", { className: "say" },
        "Drop a log onto the map: NMEA, u-blox, KrakenSDR, Agrelo and all else that the gateway reads.",
        " It stays on this machine."),
      make("div", { className: "row" }, button("Open a log", () => input.click(), { className: "main" }), input),
      choice("Locator for", LOCATORS, this.locator, (locator) => {
        this.locator = locator;
        if (this.bytes) this.#run().catch((error) => this.#fail(this.name, error));
      }),
    );
  }

  #plane() {
    return this.state?.origin && new Plane(this.state.origin);
  }

  fit() {
    const { state } = this;
    if (!state) return;
    this.stage.view.follow([...state.track, ...state.answer.sources.flatMap(extent)]);
  }
}

// The vehicle at the end of its track.
function vehicleOf(track) {
  const [before, last] = track.slice(-2);
  if (!before) return [];
  const [x, y] = last ?? before;
  const heading_deg = last ? (Math.atan2(x - before[0], y - before[1]) * 180) / Math.PI : null;
  return [{ x, y, heading_deg, kind: "vehicle" }];
}

function refusedPanel(refused) {
  return make("section", {},
    make("h2", {}, refused.length > 0 ? "Lines that were not used" : "Every line was used"),
    make("ul", { className: "list" }, refused.map(([reason, count]) => make("li", {}, `${count} × ${reason}`))),
  );
}
