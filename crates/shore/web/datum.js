// Geographic positions: converts metres east and north of the field's datum to latitude and longitude and back.

/** WGS 84: equatorial radius, m, and the square of the eccentricity. */
const RADIUS_M = 6378137;
const ECCENTRICITY_2 = 6.69437999014e-3;

const DEG = Math.PI / 180;

/** Metres per degree of latitude and of longitude, from the radii of curvature (Torge and Müller 2012, 4.1). Over a few
 * kilometres they are accurate to centimetres. */
function metresToADegree(lat_deg) {
  const root = Math.sqrt(1 - ECCENTRICITY_2 * Math.sin(lat_deg * DEG) ** 2);
  const north = (RADIUS_M * (1 - ECCENTRICITY_2)) / root ** 3;
  const east = (RADIUS_M / root) * Math.cos(lat_deg * DEG);
  return { north: north * DEG, east: east * DEG };
}

/** Latitude and longitude, degrees, of a position x m east and y m north of a datum `[latitude, longitude]`. */
export function latLonOf(datum, x, y) {
  const metres = metresToADegree(datum[0]);
  return [datum[0] + y / metres.north, datum[1] + x / metres.east];
}

/** Metres east and north of a datum for a latitude and a longitude. */
export function placeOf(datum, lat_deg, lon_deg) {
  const metres = metresToADegree(datum[0]);
  const turn = lon_deg - datum[1];
  return [(turn - 360 * Math.round(turn / 360)) * metres.east, (lat_deg - datum[0]) * metres.north];
}

/** `41.30012° N 73.90034° W` */
export function latLonWords(datum, x, y) {
  const [lat, lon] = latLonOf(datum, x, y);
  return `${Math.abs(lat).toFixed(5)}° ${lat < 0 ? 'S' : 'N'} ${Math.abs(lon).toFixed(5)}° ${lon < 0 ? 'W' : 'E'}`;
}
