// A canvas on which metres are drawn: it is moved and zoomed by mouse, touch and keys.

const LARGEST_SCALE = 200; // Pixels of a metre.
const SMALLEST_SCALE = 2e-4;
const TAP_PX = 8; // A finger that moves less taps.
// Pixels at the edges that tools and the scale bar cover.
const INSETS = { left: 20, right: 76, top: 72, bottom: 48 };

export class View {
  // `draw(context, view)` is called whenever something changed.
  constructor(canvas, draw) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.draw = draw;
    this.centre = [0, 0];
    this.scale = 0.5;
    this.stretch = 1; // How many times as high as wide a metre is drawn.
    this.following = true;
    this.tapped = () => {};
    this.pointers = new Map();
    new ResizeObserver(() => this.#resize()).observe(canvas);
    this.#listen();
    this.#resize();
  }

  // Pixels of a place in metres east and north.
  at([x, y]) {
    return [
      this.width / 2 + (x - this.centre[0]) * this.scale,
      this.height / 2 - (y - this.centre[1]) * this.scale * this.stretch,
    ];
  }

  // The place of a pixel.
  place([px, py]) {
    return [
      this.centre[0] + (px - this.width / 2) / this.scale,
      this.centre[1] - (py - this.height / 2) / (this.scale * this.stretch),
    ];
  }

  // Shows all these places, unless somebody has moved the map.
  follow(places) {
    if (this.following) this.fit(places);
    else this.request();
  }

  fit(places) {
    const known = places.filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
    if (known.length > 0) {
      const [xs, ys] = [0, 1].map((axis) => known.map((place) => place[axis]));
      const [left, right] = [Math.min(...xs), Math.max(...xs)];
      const [low, high] = [Math.min(...ys), Math.max(...ys)];
      const width = Math.max(this.width - INSETS.left - INSETS.right, 50);
      const height = Math.max(this.height - INSETS.top - INSETS.bottom, 50);
      this.#setScale(Math.min(width / Math.max(right - left, 1), height / (this.stretch * Math.max(high - low, 1))));
      this.centre = [
        (left + right) / 2 + (INSETS.right - INSETS.left) / 2 / this.scale,
        (low + high) / 2 + (INSETS.top - INSETS.bottom) / 2 / (this.scale * this.stretch),
      ];
    }
    this.request();
  }

  zoom(factor, [px, py] = [this.width / 2, this.height / 2]) {
    const [x, y] = this.place([px, py]);
    this.#setScale(this.scale * factor);
    const [u, v] = this.place([px, py]);
    this.#move(x - u, y - v);
  }

  request() {
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame(() => {
      this.requested = false;
      this.draw(this.context, this);
    });
  }

  #setScale(scale) {
    this.scale = Math.min(Math.max(scale, SMALLEST_SCALE), LARGEST_SCALE);
  }

  #move(east, north) {
    this.centre = [this.centre[0] + east, this.centre[1] + north];
    this.following = false;
    this.request();
  }

  #resize() {
    const ratio = devicePixelRatio || 1;
    this.width = Math.max(this.canvas.clientWidth, 1);
    this.height = Math.max(this.canvas.clientHeight, 1);
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.resized?.();
    this.request();
  }

  #listen() {
    const { canvas, pointers } = this;
    const position = (event) => [event.offsetX, event.offsetY];
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, position(event));
      this.start = pointers.size === 1 ? position(event) : null;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const now = position(event);
      if (this.start && distance(this.start, now) < TAP_PX) return;
      this.start = null;
      if (pointers.size === 1) {
        this.#move((before[0] - now[0]) / this.scale, (now[1] - before[1]) / (this.scale * this.stretch));
      } else {
        const [, other] = [...pointers].find(([id]) => id !== event.pointerId);
        const middle = [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2];
        this.zoom(distance(now, other) / Math.max(distance(before, other), 1), middle);
      }
      pointers.set(event.pointerId, now);
    });
    const end = (event) => {
      const tap = event.type === "pointerup" && this.start && pointers.has(event.pointerId);
      pointers.delete(event.pointerId);
      this.start = null;
      if (tap) this.tapped(this.place(position(event)), position(event));
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-0.0015 * event.deltaY), position(event));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const step = 60 / this.scale;
      const act = {
        ArrowLeft: () => this.#move(-step, 0),
        ArrowRight: () => this.#move(step, 0),
        ArrowUp: () => this.#move(0, step),
        ArrowDown: () => this.#move(0, -step),
        "+": () => this.zoom(1.4),
        "-": () => this.zoom(1 / 1.4),
      }[event.key];
      if (act) {
        event.preventDefault();
        act();
      }
    });
  }
}

function distance([x, y], [u, v]) {
  return Math.hypot(x - u, y - v);
}
