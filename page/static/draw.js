// Draws a scene: all that is known at one moment, in metres east and north. Whatever a scene lacks is not drawn.
//
// tracks [[[x, y]]], bearings [{x, y, bearing_deg, outlier, past, retracted, used, id}], particles [x, y, weight, ..],
// sources, hypotheses, advice, vehicles [{x, y, heading_deg, name, kind}], truth [[x, y]], ways [[[x, y]]],
// links [[[x, y], [x, y]]], marks [{x, y, text}], tags, site {corner, size, radios, points}, selected (the id of a
// bearing).

import { palette } from "./palette.js";

const TURN = 2 * Math.PI;
// A bearing of a larger probability of being an outlier is drawn as one.
export const OUTLIER = 0.5;

export function drawScene(context, view, scene) {
  for (const layer of LAYERS) {
    context.save();
    layer(context, view, scene);
    context.restore();
  }
}

const LAYERS = [
  background, site, ways, tracks, bearings, particles, hypotheses, sources, tags, advice, marks, truth, vehicles,
  scaleBar,
];

function background(context, view, scene) {
  context.fillStyle = palette.ground;
  context.fillRect(0, 0, view.width, view.height);
  scene.background?.(context, view);
  if (scene.hasGrid === false) return;
  const step = niceLength(110 / view.scale);
  const [left, top] = view.place([0, 0]);
  const [right, bottom] = view.place([view.width, view.height]);
  context.strokeStyle = palette.grid;
  context.beginPath();
  for (let x = Math.ceil(left / step) * step; x < right; x += step) {
    const [px] = view.at([x, 0]);
    context.moveTo(px, 0);
    context.lineTo(px, view.height);
  }
  for (let y = Math.ceil(bottom / step) * step; y < top; y += step) {
    const [, py] = view.at([0, y]);
    context.moveTo(0, py);
    context.lineTo(view.width, py);
  }
  context.stroke();
}

function site(context, view, { site }) {
  if (!site) return;
  const [left, low] = site.corner ?? [0, 0];
  const [x, y] = view.at([left, low + site.size[1]]);
  const [width, height] = [site.size[0] * view.scale, site.size[1] * view.scale * view.stretch];
  context.fillStyle = palette.panel;
  context.fillRect(x, y, width, height);
  context.strokeStyle = palette.text;
  context.lineWidth = 1.5;
  context.strokeRect(x, y, width, height);
  for (const point of site.points ?? []) dot(context, view.at(point), 1.5, palette.way);
  for (const [index, radio] of (site.radios ?? []).entries()) {
    const [px, py] = view.at(radio);
    context.fillStyle = palette.text;
    context.beginPath();
    context.moveTo(px, py - 8);
    context.lineTo(px + 7, py + 5);
    context.lineTo(px - 7, py + 5);
    context.fill();
    label(context, `radio ${index + 1}`, [px, py - 22]);
  }
}

function ways(context, view, { ways = [] }) {
  context.strokeStyle = palette.way;
  context.lineWidth = 3;
  context.setLineDash([2, 6]);
  context.lineCap = "round";
  for (const way of ways) {
    line(context, view, way);
    for (const corner of way) dot(context, view.at(corner), 4, palette.way);
  }
}

function tracks(context, view, { tracks = [] }) {
  context.strokeStyle = palette.vehicle;
  context.lineWidth = 3;
  context.lineJoin = "round";
  context.globalAlpha = 0.75;
  for (const track of tracks) line(context, view, track);
}

function bearings(context, view, scene) {
  const { bearings = [], selected } = scene;
  const newest = bearings.length - 1;
  const fade = Math.min(1, 40 / Math.max(bearings.length, 1));
  for (const [index, bearing] of bearings.entries()) {
    const isOutlier = (bearing.outlier ?? 0) > OUTLIER;
    const isOut = bearing.retracted || bearing.used === false || bearing.past;
    context.strokeStyle = isOut ? palette.retracted : isOutlier ? palette.outlier : palette.bearing;
    context.setLineDash(isOut ? [2, 7] : isOutlier ? [8, 6] : []);
    context.lineWidth = bearing.id === selected ? 5 : index === newest ? 2.5 : 1.2;
    context.globalAlpha = bearing.id === selected || index === newest ? 1 : 0.15 + 0.4 * fade;
    const [from, to] = ray(view, scene, bearing);
    context.beginPath();
    context.moveTo(...from);
    context.lineTo(...to);
    context.stroke();
    if (index === newest && !isOut) arrowHead(context, from, to);
  }
}

// The corners of a box round an ellipse.
export function extent({ x, y, ellipse: { semi_major_m, semi_minor_m, angle_deg } }) {
  const [sin, cos] = [Math.sin((angle_deg * Math.PI) / 180), Math.cos((angle_deg * Math.PI) / 180)];
  const east = Math.hypot(semi_major_m * sin, semi_minor_m * cos);
  const north = Math.hypot(semi_major_m * cos, semi_minor_m * sin);
  return [[x - east, y - north], [x + east, y + north]];
}

// Both ends of a bearing's line, in pixels.
export function ray(view, scene, bearing) {
  const angle = (bearing.bearing_deg * Math.PI) / 180;
  const length = rayLength(view, scene, bearing);
  const [x, y] = [bearing.x, bearing.y];
  return [view.at([x, y]), view.at([x + length * Math.sin(angle), y + length * Math.cos(angle)])];
}

// A little beyond what is known of the source, or across the view.
function rayLength(view, { sources = [], hypotheses = [] }, { x, y }) {
  const places = sources.length > 0 ? sources : hypotheses;
  const distances = places.map((place) => Math.hypot(place.x - x, place.y - y));
  const across = Math.hypot(view.width, view.height) / view.scale;
  return distances.length > 0 ? Math.min(1.15 * Math.max(...distances) + 20 / view.scale, 3 * across) : across;
}

function particles(context, view, { particles = [] }) {
  context.fillStyle = palette.particle;
  const count = particles.length / 3;
  const size = count > 600 ? 2.5 : 3.5;
  for (let index = 0; index < particles.length; index += 3) {
    const weight = particles[index + 2];
    if (weight < 0.02) continue;
    context.globalAlpha = Math.min(0.75, 0.25 + 0.3 * weight);
    const [px, py] = view.at([particles[index], particles[index + 1]]);
    context.fillRect(px - size / 2, py - size / 2, size, size);
  }
}

function hypotheses(context, view, { hypotheses = [], sources = [] }) {
  // A single hypothesis is what the ellipse of the fix says, too.
  if (sources.length > 0 && hypotheses.length < 2) return;
  context.strokeStyle = palette.hypothesis;
  context.lineWidth = 2;
  context.setLineDash([6, 5]);
  for (const { x, y, mass, ellipse } of hypotheses) {
    context.globalAlpha = 0.4 + 0.6 * mass;
    outline(context, view, [x, y], ellipse);
    const [px, py] = view.at([x, y]);
    label(context, `${Math.round(100 * mass)} %`, [px, py + 16], palette.hypothesis);
  }
}

function sources(context, view, { sources = [] }) {
  for (const source of sources) {
    const place = [source.x, source.y];
    context.strokeStyle = palette.source;
    context.lineWidth = 3;
    outline(context, view, place, source.ellipse);
    const [px, py] = view.at(place);
    context.beginPath();
    context.moveTo(px - 9, py);
    context.lineTo(px + 9, py);
    context.moveTo(px, py - 9);
    context.lineTo(px, py + 9);
    context.stroke();
    if (source.moving > 0.5 && source.velocity_m_s) {
      const [u, v] = source.velocity_m_s;
      const to = view.at([source.x + 20 * u, source.y + 20 * v]);
      context.beginPath();
      context.moveTo(px, py);
      context.lineTo(...to);
      context.stroke();
      arrowHead(context, [px, py], to);
    }
    if (sources.length > 1) label(context, sourceName(source), [px, py - 22], palette.source);
  }
}

// What a source is called, here and in whatever else tells of it: sources count from 0, as `$PFOXM` counts them.
export function sourceName({ number }) {
  return `Source ${number}`;
}

function tags(context, view, { tags = [] }) {
  for (const tag of tags) {
    const isGood = tag.state !== "lost" && tag.state !== "uncertain";
    for (let index = 0; index < (tag.particles ?? []).length; index += 2) {
      context.globalAlpha = 0.12;
      const [px, py] = view.at([tag.particles[index], tag.particles[index + 1]]);
      context.fillStyle = palette.particle;
      context.fillRect(px - 1.5, py - 1.5, 3, 3);
    }
    context.globalAlpha = 1;
    context.strokeStyle = isGood ? palette.source : palette.retracted;
    context.lineWidth = 2;
    context.setLineDash(isGood ? [] : [4, 4]);
    if (tag.ellipse) outline(context, view, [tag.x, tag.y], tag.ellipse);
    context.setLineDash([]);
    const [px, py] = view.at([tag.x, tag.y]);
    dot(context, [px, py], 5, context.strokeStyle);
    label(context, String(tag.id), [px, py - 12 - 15 * (tag.row ?? 0)], context.strokeStyle);
  }
}

function advice(context, view, { advice, vehicles = [] }) {
  const [vehicle] = vehicles;
  if (!advice || !vehicle) return;
  const from = view.at([vehicle.x, vehicle.y]);
  const towards = view.at([advice.x, advice.y]);
  const length = Math.hypot(towards[0] - from[0], towards[1] - from[1]);
  if (length < 1) return;
  const [u, v] = [0, 1].map((axis) => (towards[axis] - from[axis]) / length);
  const to = [from[0] + 70 * u, from[1] + 70 * v];
  context.strokeStyle = palette.advice;
  context.lineWidth = 6;
  context.lineCap = "round";
  context.beginPath();
  context.moveTo(from[0] + 20 * u, from[1] + 20 * v);
  context.lineTo(...to);
  context.stroke();
  arrowHead(context, from, to, 18);
}

function marks(context, view, { marks = [] }) {
  for (const mark of marks) {
    const [px, py] = view.at([mark.x, mark.y]);
    context.fillStyle = palette.text;
    context.beginPath();
    context.moveTo(px, py);
    context.lineTo(px - 7, py - 18);
    context.lineTo(px + 7, py - 18);
    context.fill();
    label(context, mark.text, [px, py - 28]);
  }
}

// Lines join places that belong to each other, such as a fix and the truth.
function truth(context, view, { truth = [], links = [] }) {
  context.strokeStyle = palette.truth;
  context.lineWidth = 1;
  for (const link of links) line(context, view, link);
  context.lineWidth = 2;
  for (const place of truth) {
    const [px, py] = view.at(place);
    context.beginPath();
    context.rect(px - 6, py - 6, 12, 12);
    context.stroke();
  }
}

function vehicles(context, view, { vehicles = [] }) {
  for (const vehicle of vehicles) {
    const [px, py] = view.at([vehicle.x, vehicle.y]);
    context.save();
    context.translate(px, py);
    context.fillStyle = palette.vehicle;
    context.strokeStyle = palette.ground;
    context.lineWidth = 2;
    context.beginPath();
    if (vehicle.kind === "vehicle" && vehicle.heading_deg != null) {
      context.rotate((vehicle.heading_deg * Math.PI) / 180);
      context.moveTo(0, -14);
      context.lineTo(9, 11);
      context.lineTo(0, 6);
      context.lineTo(-9, 11);
      context.closePath();
    } else if (vehicle.kind === "vehicle") {
      context.arc(0, 0, 9, 0, TURN);
    } else {
      context.rect(-8, -8, 16, 16);
    }
    context.fill();
    context.stroke();
    context.restore();
    if (vehicle.name) label(context, vehicle.name, [px, py + 24], palette.vehicle);
  }
}

function scaleBar(context, view) {
  const metres = niceLength(Math.min(140, view.width / 3) / view.scale);
  const width = metres * view.scale;
  const [x, y] = [14, view.height - 14];
  context.strokeStyle = palette.text;
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(x, y - 6);
  context.lineTo(x, y);
  context.lineTo(x + width, y);
  context.lineTo(x + width, y - 6);
  context.stroke();
  const text = metres >= 1000 ? `${metres / 1000} km` : `${metres} m`;
  label(context, text, [x + width / 2, y - 10]);
}

// The largest of 1, 2 and 5 times a power of ten that is not longer.
function niceLength(metres) {
  const power = 10 ** Math.floor(Math.log10(metres));
  const digit = metres / power >= 5 ? 5 : metres / power >= 2 ? 2 : 1;
  return Number((digit * power).toPrecision(3));
}

function line(context, view, places) {
  context.beginPath();
  for (const [index, place] of places.entries()) {
    if (index === 0) context.moveTo(...view.at(place));
    else context.lineTo(...view.at(place));
  }
  context.stroke();
}

function outline(context, view, place, { semi_major_m, semi_minor_m, angle_deg }) {
  const [px, py] = view.at(place);
  const least = 2 / view.stretch;
  const radii = [semi_major_m, semi_minor_m].map((metres) => Math.max(metres * view.scale, least));
  // Clockwise from north, on a canvas whose angles are clockwise from east.
  const angle = ((angle_deg - 90) * Math.PI) / 180;
  context.save();
  context.translate(px, py);
  context.scale(1, view.stretch);
  context.beginPath();
  context.ellipse(0, 0, radii[0], radii[1], angle, 0, TURN);
  context.restore();
  context.stroke();
}

function dot(context, [px, py], radius, colour) {
  context.fillStyle = colour;
  context.beginPath();
  context.arc(px, py, radius, 0, TURN);
  context.fill();
}

function arrowHead(context, from, to, size = 11) {
  const angle = Math.atan2(to[1] - from[1], to[0] - from[0]);
  context.save();
  context.setLineDash([]);
  context.fillStyle = context.strokeStyle;
  context.translate(...to);
  context.rotate(angle);
  context.beginPath();
  context.moveTo(size * 0.7, 0);
  context.lineTo(-size * 0.6, size * 0.6);
  context.lineTo(-size * 0.6, -size * 0.6);
  context.fill();
  context.restore();
}

// Text that is legible on anything.
function label(context, text, [px, py], colour = palette.text) {
  context.save();
  context.setLineDash([]);
  context.globalAlpha = 1;
  context.font = "600 13px system-ui, sans-serif";
  context.textAlign = "center";
  context.lineJoin = "round";
  context.lineWidth = 4;
  context.strokeStyle = palette.ground;
  context.strokeText(text, px, py);
  context.fillStyle = colour;
  context.fillText(text, px, py);
  context.restore();
}
