// What is drawn below everything: features of a GeoJSON file, or the tiles of a map.

import { palette } from "./palette.js";

// A function that draws the features.
export function backgroundOf(geojson, plane) {
  const shapes = [];
  collect(geojson, plane, shapes);
  return (context, view) => {
    for (const { kind, rings } of shapes) drawShape(context, view, kind, rings);
  };
}

function collect(value, plane, shapes) {
  const move = ([longitude, latitude]) => plane.metres(latitude, longitude);
  switch (value?.type) {
    case "FeatureCollection":
      for (const feature of value.features ?? []) collect(feature, plane, shapes);
      break;
    case "Feature":
      collect(value.geometry, plane, shapes);
      break;
    case "GeometryCollection":
      for (const geometry of value.geometries ?? []) collect(geometry, plane, shapes);
      break;
    case "LineString":
      shapes.push({ kind: "line", rings: [value.coordinates.map(move)] });
      break;
    case "MultiLineString":
      shapes.push({ kind: "line", rings: value.coordinates.map((line) => line.map(move)) });
      break;
    case "Polygon":
      shapes.push({ kind: "area", rings: value.coordinates.map((ring) => ring.map(move)) });
      break;
    case "MultiPolygon":
      for (const polygon of value.coordinates) {
        shapes.push({ kind: "area", rings: polygon.map((ring) => ring.map(move)) });
      }
      break;
    case "Point":
      shapes.push({ kind: "point", rings: [[move(value.coordinates)]] });
      break;
  }
}

function drawShape(context, view, kind, rings) {
  context.strokeStyle = palette.way;
  context.fillStyle = palette.water;
  context.lineWidth = 1.5;
  context.beginPath();
  for (const ring of rings) {
    for (const [index, place] of ring.entries()) {
      const [px, py] = view.at(place);
      if (kind === "point") context.rect(px - 2, py - 2, 4, 4);
      else if (index === 0) context.moveTo(px, py);
      else context.lineTo(px, py);
    }
  }
  if (kind === "area") context.fill("evenodd");
  context.stroke();
}

const TILE_PX = 256;
const MOST_KEPT = 400;

// Tiles that a server has, fetched as they come into view. `changed` is called when one has arrived.
export class Tiles {
  constructor(plane, { min_zoom, max_zoom }, changed) {
    Object.assign(this, { plane, min_zoom, max_zoom, changed, kept: new Map() });
  }

  draw(context, view) {
    const [north, west] = this.plane.degrees(view.place([0, 0]));
    const [south, east] = this.plane.degrees(view.place([view.width, view.height]));
    const metresOfTurn = 360 * this.plane.east;
    const best = Math.round(Math.log2((metresOfTurn * view.scale) / TILE_PX));
    const zoom = Math.min(Math.max(best, this.min_zoom), this.max_zoom);
    const count = 2 ** zoom;
    const [left, right] = [west, east].map((degrees) => Math.floor(((degrees + 180) / 360) * count));
    const [top, bottom] = [north, south].map((degrees) => Math.floor(mercator(degrees) * count));
    if ((right - left + 1) * (bottom - top + 1) > 120) return;
    for (let x = left; x <= right; x += 1) {
      for (let y = Math.max(top, 0); y <= Math.min(bottom, count - 1); y += 1) {
        const image = this.#tile(zoom, ((x % count) + count) % count, y);
        if (!image) continue;
        const corner = (u, v) => view.at(this.plane.metres(latitude(v / count), (u / count) * 360 - 180));
        const [px, py] = corner(x, y);
        const [qx, qy] = corner(x + 1, y + 1);
        context.globalAlpha = 0.75;
        context.drawImage(image, px, py, qx - px + 0.5, qy - py + 0.5);
      }
    }
    context.globalAlpha = 1;
  }

  #tile(zoom, x, y) {
    const name = `api/tiles/${zoom}/${x}/${y}`;
    const known = this.kept.get(name);
    if (known) return known.complete && known.naturalWidth > 0 ? known : null;
    const image = new Image();
    image.addEventListener("load", this.changed);
    image.src = name;
    this.kept.set(name, image);
    if (this.kept.size > MOST_KEPT) this.kept.delete(this.kept.keys().next().value);
    return null;
  }
}

// 0 at the north edge of the map, 1 at its south edge.
function mercator(degrees) {
  const sin = Math.sin((degrees * Math.PI) / 180);
  return 0.5 - Math.log((1 + sin) / (1 - sin)) / (4 * Math.PI);
}

function latitude(part) {
  return (Math.atan(Math.sinh(Math.PI * (1 - 2 * part))) * 180) / Math.PI;
}
