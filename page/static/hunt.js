// A simulated drive: a track, sources, and a locator that is told of the bearings one by one.

import { button, check, choice, make, number } from "./dom.js";
import { engine } from "./engine.js";
import { Player } from "./player.js";
import { KINDS, PARTICLES, REFINEMENTS, SCENARIOS, engineOptions } from "./scenarios.js";
import { answerPanel, legend, metres } from "./words.js";

const SPEEDS = [[2, "2 bearings a second"], [8, "8 a second"], [30, "30 a second"], [120, "120 a second"]];
const LEGEND = [
  "Arrowhead: the vehicle. Thick line: its track; dotted: the way that it will take.",
  "Thin lines: bearings, the newest with an arrow.",
  "Dashed: taken for outliers. Dotted: of where a source was before.",
  "Dots: particles. Cross and ellipse: a fix, and what holds the source with 95 %.",
  "Dashed ellipses with a percentage: places that fit, before there is a fix.",
  "Thick short arrow: where to drive. Square: where the source truly is.",
];
const DRAWING_M_S = 6; // Of a source whose way is drawn.

export class Hunt {
  title = "Drive";

  constructor(stage) {
    this.stage = stage;
    this.settings = structuredClone(SCENARIOS.clean);
    this.scenario = "clean";
    this.showsTruth = true;
    this.tools = this.#makeTools();
    this.form = this.#makeForm();
    this.legend = legend(LEGEND);
    this.player = new Player({
      length: 0,
      seek: (position) => this.#seek(position),
      words: (position) => `${position} of ${this.state?.count ?? 0} bearings`,
      speeds: SPEEDS,
      speed: 8,
    });
  }

  async open() {
    this.engine ??= await engine();
    this.#start();
    this.stage.view.following = true;
    this.fit();
  }

  close() {
    this.player.pause();
  }

  scene() {
    const { state, settings } = this;
    const base = { ways: [settings.vehicle.corners, ...settings.sources.map((source) => source.corners)] };
    if (!state) return base;
    const moved = state.bearings.map(({ x, y }) => [x, y]);
    return {
      ...base,
      ...state.answer,
      tracks: [moved],
      bearings: state.bearings,
      vehicles: [{ x: state.vehicle[0], y: state.vehicle[1], heading_deg: state.heading_deg, kind: "vehicle" }],
      truth: this.showsTruth ? state.truth : [],
    };
  }

  // A tap while something is drawn.
  tapped(place) {
    const { settings, tool } = this;
    const [x, y] = place.map(Math.round);
    if (tool === "track") {
      settings.vehicle.corners.push([x, y]);
    } else if (tool === "source") {
      settings.sources.push({ corners: [[x, y]], speed_m_s: 0, start_s: 0 });
    } else if (tool === "way" && settings.sources.length > 0) {
      const source = settings.sources.at(-1);
      source.corners.push([x, y]);
      source.speed_m_s = DRAWING_M_S;
    } else {
      return false;
    }
    this.#start();
    return true;
  }

  panel() {
    return [
      this.player.element,
      this.error && make("p", { className: "error", role: "alert" }, this.error),
      this.state && answerPanel({
        answer: this.state.answer,
        bearings: this.state.bearings,
        extra: [["Error of the fix", metres(this.#error())]],
      }),
      this.form,
      this.legend,
    ];
  }

  fit() {
    const { vehicle, sources } = this.settings;
    this.stage.view.follow([...vehicle.corners, ...sources.flatMap((source) => source.corners)]);
  }

  #makeTools() {
    const pick = (name, text, title) => button(text, () => this.#pick(name), {
      id: `tool-${name}`,
      title,
      ariaPressed: String(this.tool === name),
    });
    return [
      pick("track", "Track", "Tap the corners of the vehicle's track"),
      pick("source", "Sources", "Tap where sources are"),
      pick("way", "Motion", "Tap where the last source drives"),
      this.tool ? button("Done", () => this.#pick(null), { className: "main", id: "tool-done" }) : null,
    ];
  }

  #makeForm() {
    const { settings } = this;
    const set = (name) => (value) => this.#set({ [name]: value });
    const rate = (name) => (value) => this.#set({ [name]: value / 100 });
    const scenarios = Object.entries(SCENARIOS).map(([name, { title }]) => [name, title]);
    const refinement = choice("Refinement", REFINEMENTS, settings.refinement, set("refinement"));
    const refine = (kind) => { refinement.querySelector("select").disabled = kind !== "clean"; };
    refine(settings.kind);
    return make("section", { id: "settings" },
      choice("Scenario", scenarios, this.scenario, (name) => this.#load(name)),
      choice("Locator for", KINDS, settings.kind, (kind) => {
        refine(kind);
        this.#set({ kind });
      }),
      choice("Particles", PARTICLES, String(settings.particles), set("particles")),
      refinement,
      number("Seed", { value: settings.seed, min: 0, max: 2 ** 31 }, set("seed")),
      make("details", {},
        make("summary", {}, "Bearings and vehicle"),
        number("Sigma, degrees", { value: settings.sigma_deg, min: 0.2, max: 45, step: 0.5 }, set("sigma_deg")),
        number("Outliers, %", { value: percent(settings.outlier_rate), min: 0, max: 90, step: 5 },
          rate("outlier_rate")),
        number("Mirrored, %", { value: percent(settings.mirrored_rate), min: 0, max: 10 }, rate("mirrored_rate")),
        number("Array bias, degrees", { value: settings.bias_deg, min: -30, max: 30 }, set("bias_deg")),
        number("Seconds between", { value: settings.interval_s, min: 0.2, max: 60, step: 0.5 }, set("interval_s")),
        number("Speed, m/s", { value: settings.vehicle.speed_m_s, min: 0.5, max: 60 },
          (speed_m_s) => this.#set({ vehicle: { ...settings.vehicle, speed_m_s } })),
        check("Show where sources are", this.showsTruth, (shows) => {
          this.showsTruth = shows;
          this.stage.render();
        }),
      ),
    );
  }

  // Distance of the best fix to the nearest source.
  #error() {
    const [fix] = this.state.answer.sources;
    if (!fix || !this.showsTruth) return null;
    return Math.min(...this.state.truth.map(([x, y]) => Math.hypot(x - fix.x, y - fix.y)));
  }

  // Takes up a tool, or lays it down. A track and sources are drawn anew.
  #pick(tool) {
    this.tool = this.tool === tool ? null : tool;
    if (this.tool === "track") this.settings.vehicle.corners = [];
    if (this.tool === "source") this.settings.sources = [];
    this.tools = this.#makeTools();
    this.#start();
  }

  #load(name) {
    this.scenario = name;
    this.settings = structuredClone(SCENARIOS[name]);
    this.form = this.#makeForm();
    this.#start();
    this.stage.view.following = true;
    this.fit();
  }

  #set(change) {
    Object.assign(this.settings, change);
    this.#start();
  }

  #start() {
    this.player.pause();
    this.error = null;
    try {
      const options = engineOptions(this.settings);
      this.state = this.engine.startHunt(options);
      this.player.reset(this.state.count);
    } catch (error) {
      this.state = null;
      this.player.reset(0);
      const { vehicle, sources } = this.settings;
      const isUnfinished = this.tool && (vehicle.corners.length === 0 || sources.length === 0);
      this.error = isUnfinished ? "Tap places on the map." : `This cannot be simulated: ${error.message}.`;
    }
    this.stage.render();
  }

  #seek(position) {
    if (!this.state) return;
    this.state = this.engine.seekHunt(position);
    this.stage.render();
  }
}

function percent(rate) {
  return Math.round(100 * rate);
}
