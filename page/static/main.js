// The page: live, if the server that it came from has something to show; on its own otherwise.

import { button } from "./dom.js";
import { drawScene } from "./draw.js";
import { Hunt } from "./hunt.js";
import { Live } from "./live.js";
import { themes } from "./palette.js";
import { Replay } from "./replay.js";
import { View } from "./view.js";
import { Walkers } from "./walkers.js";

const byId = (id) => document.getElementById(id);

// Where a mode shows itself.
class Stage {
  constructor() {
    this.canvas = byId("canvas");
    this.view = new View(this.canvas, (context, view) => drawScene(context, view, this.mode?.scene() ?? {}));
    this.view.tapped = (place, pixel) => this.mode?.tapped(place, pixel);
    this.view.resized = () => this.view.following && this.mode?.fit();
    byId("zoom-in").addEventListener("click", () => this.view.zoom(1.5));
    byId("zoom-out").addEventListener("click", () => this.view.zoom(1 / 1.5));
    byId("zoom-fit").addEventListener("click", () => {
      this.view.following = true;
      this.mode?.fit();
    });
  }

  async show(mode) {
    this.mode?.close();
    this.mode = mode;
    this.popup();
    this.tabs();
    byId("panel").scrollTop = 0;
    await mode.open();
  }

  // Draws all anew, once a frame.
  render() {
    if (this.rendering) return;
    this.rendering = true;
    requestAnimationFrame(() => {
      this.rendering = false;
      if (!this.mode) return;
      keepChildren(byId("panel"), this.mode.panel());
      keepChildren(byId("tools"), this.mode.tools);
      this.canvas.classList.toggle("picking", Boolean(this.mode.tool));
      this.view.request();
    });
  }

  // Shows something about what was tapped; nothing closes it.
  popup(...children) {
    const popup = byId("popup");
    popup.replaceChildren(...children);
    popup.hidden = children.length === 0;
  }

  // Marks the tab of what is shown, and hides those of what there is not.
  tabs() {
    for (const tab of byId("tabs").children) {
      tab.ariaSelected = String(tab.mode === this.mode);
      tab.hidden = Boolean(tab.mode.isHidden);
    }
  }

  connection(text, isGood) {
    const element = byId("connection");
    element.hidden = false;
    element.textContent = text;
    element.classList.toggle("good", isGood);
  }
}

// Makes these the children. Whatever is among them already is not touched: it keeps the focus, and a finger on it.
function keepChildren(parent, wanted) {
  const children = wanted.filter(Boolean);
  for (const child of [...parent.children]) {
    if (!children.includes(child)) child.remove();
  }
  for (const [index, child] of children.entries()) {
    if (parent.children[index] !== child) parent.insertBefore(child, parent.children[index] ?? null);
  }
}

function addTabs(stage, modes) {
  for (const mode of modes) {
    const tab = button(mode.title, () => stage.show(mode), { role: "tab" });
    tab.mode = mode;
    byId("tabs").append(tab);
  }
}

// Logs are dropped anywhere.
function takeDrops(stage, replay) {
  const drop = byId("drop");
  addEventListener("dragover", (event) => {
    event.preventDefault();
    drop.hidden = false;
  });
  addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) drop.hidden = true;
  });
  addEventListener("drop", async (event) => {
    event.preventDefault();
    drop.hidden = true;
    const [file] = event.dataTransfer.files;
    if (!file) return;
    await stage.show(replay);
    await replay.take(file);
  });
}

const stage = new Stage();
themes(byId("theme"), () => stage.render());
const live = await Live.find(stage);
const [hunt, replay, walkers] = [new Hunt(stage), new Replay(stage), new Walkers(stage)];
addTabs(stage, [...(live ? live.modes : []), hunt, replay, walkers]);
takeDrops(stage, replay);
await stage.show(live ? live.modes[0] : hunt);
// For whoever looks at the page from its console, and for its tests.
globalThis.foxhunt = { stage, hunt, replay, walkers, live };
requestAnimationFrame(() => requestAnimationFrame(() => { document.documentElement.dataset.ready = "yes"; }));
