// The colours of the drawing: those of the style sheet, which follow the theme.

const NAMES = [
  "ground", "text", "faint", "rule", "grid", "accent", "vehicle", "bearing", "outlier", "particle",
  "source", "hypothesis", "advice", "truth", "retracted", "way", "water", "panel",
];
const THEMES = ["auto", "light", "dark"];
const night = matchMedia("(prefers-color-scheme: dark)");

export const palette = {};

// Takes the theme that was chosen here before, and lets a button choose another.
export function themes(button, changed) {
  let chosen = recall();
  const apply = () => {
    const dark = chosen === "dark" || (chosen === "auto" && night.matches);
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    button.textContent = { auto: "Auto", light: "Light", dark: "Dark" }[chosen];
    const style = getComputedStyle(document.documentElement);
    for (const name of NAMES) palette[name] = style.getPropertyValue(`--${name}`).trim();
    changed();
  };
  night.addEventListener("change", apply);
  button.addEventListener("click", () => {
    chosen = THEMES[(THEMES.indexOf(chosen) + 1) % THEMES.length];
    try { localStorage.setItem("foxhunt-theme", chosen); } catch { /* Private windows keep nothing. */ }
    apply();
  });
  apply();
}

function recall() {
  try {
    const kept = localStorage.getItem("foxhunt-theme");
    return THEMES.includes(kept) ? kept : "auto";
  } catch {
    return "auto";
  }
}
