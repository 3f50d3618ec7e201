// Tags on a site, as `foxhunt live` tells of them.

import { make, table } from "./dom.js";
import { legend, metres } from "./words.js";

export class Site {
  title = "Site";
  tools = [];

  constructor(stage, live) {
    this.stage = stage;
    this.live = live;
    this.legend = legend([
      "Rectangle: the site. Dots and ellipses: where tags are, and what holds them with 95 %.",
    ]);
  }

  get isHidden() {
    return !this.live.store.site;
  }

  open() {
    this.stage.view.following = true;
    this.stage.render();
    this.fit();
  }

  close() {}

  tapped() {}

  scene() {
    const { site } = this.live.store;
    if (!site) return {};
    return {
      site: { size: [site.width, site.height], radios: site.points },
      tags: this.#tags(),
      hasGrid: false,
    };
  }

  panel() {
    const { site } = this.live.store;
    const tags = this.#tags();
    const rows = tags.map((tag) => {
      const sigma = tag.covariance ? ` ± ${metres(Math.sqrt(Math.max(tag.covariance[0], tag.covariance[2])))}` : "";
      const room = [tag.room, tag.floor].filter((part) => part != null).join(", ");
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
    const { site } = this.live.store;
    if (site) this.stage.view.follow([[0, 0], [site.width, site.height]]);
  }

  #tags() {
    const { site, tags } = this.live.store;
    const here = [...tags.values()].filter((tag) => tag.site === site?.name);
    return here.sort((a, b) => Number(a.id) - Number(b.id));
  }
}
