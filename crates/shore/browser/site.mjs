// Invented charts of the site of the shipped fields.

import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { deflateSync } from 'node:zlib';

/** The datum of the shipped fields: latitude and longitude, degrees. */
const DATUM = [41.3548, -74.0551];

/** CRC-32 as in PNG. */
function crc(bytes) {
  let sum = ~0;
  for (const byte of bytes) {
    sum ^= byte;
    for (let bit = 0; bit < 8; bit++) sum = (sum >>> 1) ^ (sum & 1 ? 0xedb88320 : 0);
  }
  return ~sum >>> 0;
}

function chunk(kind, data) {
  const body = Buffer.concat([Buffer.from(kind), data]);
  const [length, sum] = [Buffer.alloc(4), Buffer.alloc(4)];
  length.writeUInt32BE(data.length);
  sum.writeUInt32BE(crc(body));
  return Buffer.concat([length, body, sum]);
}

/** A PNG of these pixels; `colour(x, y)` returns red, green and blue. */
function png(width, height, colour) {
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 2, 0, 0, 0], 8);
  const rows = Buffer.alloc(height * (1 + 3 * width));
  for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) rows.set(colour(x, y), y * (1 + 3 * width) + 1 + 3 * x);
  return Buffer.concat([Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]), chunk('IHDR', head), chunk('IDAT', deflateSync(rows)), chunk('IEND', Buffer.alloc(0))]);
}

/** Writes charts to a folder: shorelines south and north of the field, and an image around the field, red in the west and green in the east. Returns
 * their files, and positions with known colours, m east and north of the datum. */
export function site(folder, [lat, lon] = DATUM) {
  // Metres per degree of WGS 84 by the usual series, unlike the page's formula.
  const cos = (times) => Math.cos((times * lat * Math.PI) / 180);
  const north = 1 / (111_132.92 - 559.82 * cos(2) + 1.175 * cos(4));
  const east = 1 / (111_412.84 * cos(1) - 93.5 * cos(3) + 0.118 * cos(5));
  const at = ([x, y]) => [lon + x * east, lat + y * north];
  const shore = [[-60, -40], [-60, -22], [-20, -12], [30, -9], [70, -16], [120, -10], [220, -24], [220, -40], [-60, -40]].map(at);
  const features = [
    { type: 'Feature', properties: { name: 'south shore' }, geometry: { type: 'Polygon', coordinates: [shore] } },
    { type: 'Feature', properties: {}, geometry: { type: 'Polygon', coordinates: [[[104, 83], [124, 83], [118, 90], [106, 89], [104, 83]].map(at)] } },
    { type: 'Feature', properties: {}, geometry: { type: 'LineString', coordinates: [[-40, 92], [40, 88], [98, 92]].map(at) } },
    { type: 'Feature', properties: { name: 'Dock' }, geometry: { type: 'Point', coordinates: at([70, -16]) } },
  ];
  const geojson = join(folder, 'harbour.geojson');
  writeFileSync(geojson, JSON.stringify({ type: 'FeatureCollection', features }));
  const image = join(folder, 'harbour.png');
  // 400 m by 200 m; the first pixel's corner is 120 m west and 140 m north of the datum.
  const [width, height, metres] = [200, 100, 2];
  writeFileSync(image, png(width, height, (x) => (x < width / 2 ? [230, 40, 40] : [40, 230, 40])));
  const [left, top] = at([-120 + metres / 2, 140 - metres / 2]);
  writeFileSync(join(folder, 'harbour.pgw'), `${metres * east}\n0\n0\n${-metres * north}\n${left}\n${top}\n`);
  return { geojson, image, within: [112, 85], beside: [90, 84], red: [77, -5], green: [83, -5] };
}
