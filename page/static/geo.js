// Degrees to metres east and north of an origin, and back: to draw, within some tens of kilometres.

const SEMI_MAJOR_M = 6_378_137;
const ECCENTRICITY_2 = 6.69438e-3;
const RADIANS = Math.PI / 180;

export class Plane {
  constructor([latitude, longitude]) {
    this.origin = [latitude, longitude];
    const sin = Math.sin(latitude * RADIANS);
    const w2 = 1 - ECCENTRICITY_2 * sin * sin;
    const prime = SEMI_MAJOR_M / Math.sqrt(w2);
    this.east = RADIANS * prime * Math.cos(latitude * RADIANS);
    this.north = (RADIANS * prime * (1 - ECCENTRICITY_2)) / w2;
  }

  // Metres east and north.
  metres(latitude, longitude) {
    const turned = ((longitude - this.origin[1] + 540) % 360) - 180;
    return [turned * this.east, (latitude - this.origin[0]) * this.north];
  }

  // Latitude and longitude.
  degrees([x, y]) {
    return [this.origin[0] + y / this.north, this.origin[1] + x / this.east];
  }
}
