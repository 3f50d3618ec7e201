// Play, pause, step and rewind, with a slider: says to which position to go.

import { button, choice, make } from "./dom.js";

export class Player {
  // `seek(position)` is called with whole numbers from 0 to `length`; `words(position)` describes one. Every second of
  // playing goes so many positions on as the chosen of `speeds` says: [number, text].
  constructor({ length, seek, words, speeds, speed }) {
    Object.assign(this, { length, seek, words, speed, position: 0, playing: false });
    this.slider = make("input", { type: "range", min: 0, max: length, step: 1, value: 0 });
    this.slider.setAttribute("aria-label", "Position");
    this.slider.addEventListener("input", () => {
      this.pause();
      this.go(Number(this.slider.value));
    });
    this.output = make("output", {});
    this.toggle = button("Play", () => (this.playing ? this.pause() : this.play()), { className: "main", id: "play" });
    this.element = make("section", {},
      make("div", { className: "player" },
        button("Rewind", () => { this.pause(); this.go(0); }, { id: "rewind" }),
        button("Back", () => { this.pause(); this.go(this.position - 1); }, { id: "back" }),
        this.toggle,
        button("Step", () => { this.pause(); this.go(this.position + 1); }, { id: "step" }),
        this.slider,
        this.output,
      ),
      choice("Speed", speeds, speed, (value) => { this.speed = Number(value); }),
    );
    this.#show();
  }

  reset(length) {
    this.length = length;
    this.slider.max = length;
    this.position = 0;
    this.#show();
  }

  go(position) {
    this.position = Math.min(Math.max(Math.round(position), 0), this.length);
    this.seek(this.position);
    this.#show();
  }

  play() {
    if (this.position >= this.length) this.go(0);
    this.playing = true;
    this.toggle.textContent = "Pause";
    let last = performance.now();
    let due = 0;
    const tick = (now) => {
      if (!this.playing) return;
      due += ((now - last) / 1000) * this.speed;
      last = now;
      const whole = Math.floor(due);
      if (whole > 0) {
        due -= whole;
        this.go(this.position + whole);
      }
      if (this.position >= this.length) this.pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  pause() {
    this.playing = false;
    this.toggle.textContent = "Play";
  }

  #show() {
    this.slider.value = this.position;
    this.output.textContent = this.words(this.position);
  }
}
