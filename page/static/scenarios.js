// Drives to begin with. Metres east and north; speeds in metres a second.

const LOOP = [[0, 0], [900, 0], [1200, 500], [900, 1000]];
const AT_REST = { speed_m_s: 0, start_s: 0 };

const BASIS = {
  vehicle: { corners: LOOP, speed_m_s: 15, start_s: 0 },
  sources: [{ corners: [[450, 800]], ...AT_REST }],
  interval_s: 2,
  sigma_deg: 3,
  outlier_rate: 0,
  mirrored_rate: 0,
  bias_deg: 0,
  seed: 1,
  kind: "clean",
  particles: 256,
  refinement: "none",
};

export const SCENARIOS = {
  clean: { title: "One source, clean bearings", ...BASIS },
  city: { title: "In a city: outliers", ...BASIS, outlier_rate: 0.25, mirrored_rate: 0.05, kind: "robust" },
  biased: { title: "An array that is mounted askew", ...BASIS, bias_deg: 4, kind: "robust" },
  two: {
    title: "Two sources",
    ...BASIS,
    sources: [{ corners: [[350, 700]], ...AT_REST }, { corners: [[1500, 150]], ...AT_REST }],
    outlier_rate: 0.05,
    interval_s: 1,
    kind: "several",
  },
  moving: {
    title: "A source that drives off",
    ...BASIS,
    vehicle: {
      corners: [[0, 0], [800, 0], [800, 700], [0, 700], [0, 0], [800, 0], [800, 700], [0, 700]],
      speed_m_s: 15,
      start_s: 0,
    },
    sources: [{ corners: [[300, 350], [1500, 600]], speed_m_s: 6, start_s: 120 }],
    interval_s: 1,
    kind: "moving",
  },
};

export const KINDS = [
  ["clean", "Clean bearings"],
  ["robust", "Outliers and bias"],
  ["moving", "A source that may move"],
  ["several", "Several sources"],
];
export const REFINEMENTS = [
  ["none", "None"],
  ["fish", "Fish school"],
  ["firefly", "Fireflies"],
  ["evolution", "Differential evolution"],
];
export const PARTICLES = [["100", "100"], ["256", "256"], ["1000", "1000"]];

const RADIANS = Math.PI / 180;

// What the engine is told. Compass angles grow clockwise, its own counter-clockwise.
export function engineOptions(settings) {
  const { seed, vehicle, sources, interval_s, outlier_rate, mirrored_rate } = settings;
  return {
    scenario: {
      seed,
      vehicle,
      sources,
      interval_s,
      sigma_rad: settings.sigma_deg * RADIANS,
      outlier_rate,
      mirrored_rate,
      bias_rad: settings.bias_deg === 0 ? 0 : -settings.bias_deg * RADIANS,
    },
    locator: {
      kind: settings.kind,
      particles: Number(settings.particles),
      refinement: settings.kind === "clean" ? settings.refinement : "none",
    },
  };
}
