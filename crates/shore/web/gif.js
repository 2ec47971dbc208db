// An encoder for animated GIF files, as in the GIF89a specification: no browser library for this is maintained.

/** Codes of LZW with 8 bits per pixel: clear the table, end of the data. */
const CLEAR = 256;
const END = 257;
const CODES = 4096;
/** Index of pixels that have not changed; the colours have the indices below. */
const SAME = 255;

/** Bytes that grow. */
class Bytes {
  constructor() {
    this.data = new Uint8Array(1 << 16);
    this.length = 0;
  }

  put(...bytes) {
    for (const byte of bytes) {
      if (this.length === this.data.length) {
        const more = new Uint8Array(2 * this.length);
        more.set(this.data);
        this.data = more;
      }
      this.data[this.length++] = byte;
    }
  }

  word(value) {
    this.put(value & 255, value >> 8);
  }
}

/** Compresses indices into `out`, in blocks of at most 255 bytes. */
function compress(indices, table, out) {
  const block = [];
  let [bits, count, size, next] = [0, 0, 9, END + 1];
  const byte = (value) => {
    block.push(value);
    if (block.length === 255) out.put(255, ...block.splice(0));
  };
  const code = (value) => {
    bits |= value << count;
    for (count += size; count >= 8; count -= 8, bits >>>= 8) byte(bits & 255);
  };
  const clear = () => {
    table.fill(0);
    code(CLEAR);
    [size, next] = [9, END + 1];
  };
  clear();
  let prefix = indices[0];
  for (let i = 1; i < indices.length; i++) {
    const at = (prefix << 8) | indices[i];
    if (table[at] !== 0) {
      prefix = table[at];
      continue;
    }
    code(prefix);
    prefix = indices[i];
    if (next === CODES) clear();
    else {
      if (next === 1 << size) size += 1;
      table[at] = next++;
    }
  }
  code(prefix);
  code(END);
  if (count > 0) byte(bits & 255);
  if (block.length > 0) out.put(block.length, ...block);
  out.put(0);
}

/** The bin of a colour: five bits of each component. */
const binOf = (data, i) => ((data[i] >> 3) << 10) | ((data[i + 1] >> 3) << 5) | (data[i + 2] >> 3);

export class Gif {
  constructor(width, height) {
    Object.assign(this, { width, height, frames: 0 });
    this.out = new Bytes();
    this.indices = new Uint8Array(width * height);
    this.table = new Uint16Array(CODES << 8);
  }

  /** Adds a picture, RGBA, shown for this time, ms. */
  add(data, shown_ms) {
    if (this.frames === 0) this.begin(data);
    const last = this.last;
    const pixels = new Uint32Array(data.buffer);
    for (let i = 0; i < this.indices.length; i++) {
      this.indices[i] = last && last[i] === pixels[i] ? SAME : this.indexOf(data, i * 4);
    }
    this.last = pixels;
    this.frames += 1;
    const { out } = this;
    // Keep the picture, with a transparent colour, for this many hundredths of a second.
    out.put(0x21, 0xf9, 4, 0b101);
    out.word(Math.max(2, Math.round(shown_ms / 10)));
    out.put(SAME, 0, 0x2c);
    for (const value of [0, 0, this.width, this.height]) out.word(value);
    out.put(0, 8);
    compress(this.indices, this.table, out);
  }

  /** The header, with the most frequent colours of the first picture. */
  begin(data) {
    const counts = new Uint32Array(1 << 15);
    const first = new Uint32Array(1 << 15);
    for (let i = 0; i < data.length; i += 4) {
      const bin = binOf(data, i);
      if (counts[bin]++ === 0) first[bin] = i;
    }
    const bins = [...counts.keys()].filter((bin) => counts[bin] > 0).sort((a, b) => counts[b] - counts[a]).slice(0, SAME);
    this.colours = bins.map((bin) => [0, 1, 2].map((part) => data[first[bin] + part]));
    /** The nearest colour by bin, plus 1; 0 means not known yet. */
    this.nearest = new Uint16Array(1 << 15);
    const { out } = this;
    out.put(...[...'GIF89a'].map((letter) => letter.charCodeAt(0)));
    out.word(this.width);
    out.word(this.height);
    out.put(0xf7, 0, 0);
    for (let i = 0; i < 256; i++) out.put(...(this.colours[i] ?? [0, 0, 0]));
    // Repeats forever.
    out.put(0x21, 0xff, 11, ...[...'NETSCAPE2.0'].map((letter) => letter.charCodeAt(0)), 3, 1, 0, 0, 0);
  }

  /** The index of the colour that is nearest to a pixel. */
  indexOf(data, i) {
    const bin = binOf(data, i);
    if (this.nearest[bin] === 0) {
      let least = Infinity;
      this.colours.forEach(([red, green, blue], index) => {
        const far = (red - data[i]) ** 2 + (green - data[i + 1]) ** 2 + (blue - data[i + 2]) ** 2;
        if (far < least) [least, this.nearest[bin]] = [far, index + 1];
      });
    }
    return this.nearest[bin] - 1;
  }

  /** The file. */
  finish() {
    this.out.put(0x3b);
    return new Blob([this.out.data.subarray(0, this.out.length)], { type: 'image/gif' });
  }
}
