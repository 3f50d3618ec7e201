// Eight people in a tunnel, each with a tag that four radios hear.

import { check, make, number, table } from "./dom.js";
import { engine } from "./engine.js";
import { Player } from "./player.js";
import { legend } from "./words.js";

const END_S = 60;
const STEPS = 4; // Of a second.
const STRETCH = 6;

export class Walkers {
  title = "Tunnel";

  constructor(stage) {
    this.stage = stage;
    this.options = { seed: 1, noise_db: 4, loss: 0.05, outage: true };
    this.tools = [];
    this.form = this.#makeForm();
    this.legend = legend([
      `Rectangle: the tunnel, drawn ${STRETCH} times as wide as it is. Triangles: radios.`,
      "Dot and ellipse: where a tag is, and what holds it with 95 %; dashed while it is uncertain.",
      "Small dots: particles. Squares: where people truly are, with a line to where they were located.",
    ]);
    this.player = new Player({
      length: END_S * STEPS,
      seek: (position) => this.#seek(position),
      words: (position) => `${(position / STEPS).toFixed(2)} s of ${END_S} s`,
      speeds: [[STEPS, "As it was"], [4 * STEPS, "4 times as fast"], [16 * STEPS, "16 times as fast"]],
      speed: 4 * STEPS,
    });
  }

  async open() {
    this.engine ??= await engine();
    if (!this.state) this.#start();
    this.stage.view.stretch = STRETCH;
    this.stage.view.following = true;
    this.fit();
    this.stage.render();
  }

  close() {
    this.player.pause();
    this.stage.view.stretch = 1;
  }

  scene() {
    const { state } = this;
    if (!state) return {};
    const truth = new Map(state.truth);
    const links = state.tags.filter((tag) => truth.has(tag.id)).map((tag) => [[tag.x, tag.y], truth.get(tag.id)]);
    // Neighbours along the tunnel have their labels one above the other.
    const tags = state.tags.toSorted((one, other) => one.x - other.x).map((tag, index) => ({ ...tag, row: index % 3 }));
    return { site: state, tags, truth: [...truth.values()], links, hasGrid: false };
  }

  tapped() {
    return false;
  }

  panel() {
    const { state } = this;
    if (!state) return [];
    const truth = new Map(state.truth);
    const tags = state.tags.map((tag) => {
      const place = truth.get(tag.id);
      const error = place ? `${Math.abs(place[0] - tag.x).toFixed(1)} m off` : "has left";
      const state = tag.state === "tracking" ? "" : ` ${tag.state},`;
      return [`Tag ${tag.id}`, `${tag.x.toFixed(1)} ± ${Math.sqrt(tag.covariance[0]).toFixed(1)} m,${state} ${error}`];
    });
    return [
      this.player.element,
      make("section", { id: "answer" },
        make("p", { className: "headline" }, tags.length > 0 ? `${tags.length} tags located` : "No tag located yet"),
        tags.length > 0 ? null : make("p", { className: "say" }, "A place takes some packets of at least one radio."),
        table([...tags, ["Packets heard", String(state.packets)]]),
      ),
      this.form,
      this.legend,
    ];
  }

  #makeForm() {
    const { options } = this;
    return make("section", {},
      number("Seed", { value: options.seed, min: 0, max: 2 ** 31 }, (seed) => this.#set({ seed })),
      number("Noise, dB", { value: options.noise_db, min: 0, max: 12 }, (noise_db) => this.#set({ noise_db })),
      number("Lost packets, %", { value: 100 * options.loss, min: 0, max: 90, step: 5 },
        (percent) => this.#set({ loss: percent / 100 })),
      check("Radio 4 off, 30 to 42 s", options.outage, (outage) => this.#set({ outage })),
    );
  }

  #set(change) {
    Object.assign(this.options, change);
    this.#start();
    this.stage.render();
  }

  #start() {
    this.state = this.engine.startWalkers(this.options);
    const { position } = this.player;
    if (position > 0) this.#seek(position);
  }

  #seek(position) {
    this.state = this.engine.seekWalkers(Math.round((1000 * position) / STEPS));
    this.stage.render();
  }

  fit() {
    if (this.state) this.stage.view.follow([[0, -1], [this.state.size[0], this.state.size[1] + 1]]);
  }
}
