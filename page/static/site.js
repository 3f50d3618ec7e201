// Tags on a site, as `foxhunt live` tells of them.

import { make, table } from "./dom.js";
import { legend, metres } from "./words.js";

const MARGIN_M = 2;
const MOST_STRETCH = 6; // Of a tunnel, which is long and narrow.

export class Site {
  title = "Site";
  tools = [];

  constructor(stage, live) {
    this.stage = stage;
    this.live = live;
    this.legend = legend([
      "Rectangle: the site; a narrow one is drawn wider than it is.",
      "Dots and ellipses: where tags are, and what holds them with 95 %.",
    ]);
  }

  get isHidden() {
    return !this.live.store.site;
  }

  open() {
    const [width, height] = this.#box().size;
    this.stage.view.stretch = Math.min(Math.max(Math.round(width / (4 * height)), 1), MOST_STRETCH);
    this.stage.view.following = true;
    this.stage.render();
    this.fit();
  }

  close() {
    this.stage.view.stretch = 1;
  }

  tapped() {}

  scene() {
    const { site } = this.live.store;
    if (!site) return {};
    return {
      site: { ...this.#box(), points: site.points },
      tags: this.#tags().toSorted((one, other) => one.x - other.x).map((tag, index) => ({ ...tag, row: index % 3 })),
      hasGrid: false,
    };
  }

  panel() {
    const { site } = this.live.store;
    const tags = this.#tags();
    const rows = tags.map((tag) => {
      const sigma = tag.covariance ? ` ± ${metres(Math.sqrt(Math.max(tag.covariance[0], tag.covariance[2])))}` : "";
      const percent = (probability) => (probability == null ? "" : ` (${Math.round(100 * probability)} %)`);
      const room = [
        tag.room != null && `${tag.room}${percent(tag.room_probability)}`,
        tag.floor != null && `floor ${tag.floor}${percent(tag.floor_probability)}`,
      ].filter(Boolean).join(", ");
      return [`Tag ${tag.id}`, `${room ? `${room}: ` : ""}${tag.x.toFixed(1)}, ${tag.y.toFixed(1)} m${sigma}`];
    });
    return [
      make("section", { id: "answer" },
        make("p", { className: "headline" }, tags.length === 1 ? "1 tag located" : `${tags.length} tags located`),
        make("p", { className: "say" }, site?.name ?? ""),
        table(rows)),
      this.legend,
    ];
  }

  fit() {
    if (this.isHidden) return;
    const { corner: [x, y], size: [width, height] } = this.#box();
    this.stage.view.follow([[x, y], [x + width, y + height]]);
  }

  // The corner of the site and its size, with a margin round the points of its map.
  #box() {
    const { site } = this.live.store;
    const points = site.points?.length > 0 ? site.points : [[0, 0], [site.width, site.height]];
    const axes = [0, 1].map((axis) => points.map((point) => point[axis]));
    const [low, high] = [Math.min, Math.max].map((end) => axes.map((values) => end(...values)));
    const corner = low.map((metres) => metres - MARGIN_M);
    return { corner, size: [0, 1].map((axis) => high[axis] - low[axis] + 2 * MARGIN_M) };
  }

  #tags() {
    const { site, tags } = this.live.store;
    const here = [...tags.values()].filter((tag) => tag.site === site?.name);
    return here.sort((a, b) => Number(a.id) - Number(b.id));
  }
}
