// Reads CDR messages by their .msg definitions. Each definition is parsed once and becomes a reader.

/** 2^32: 64-bit integers are read as two halves. Simulated nanoseconds stay exact for a hundred days. */
const HALF = 4294967296;

/** Size in bytes, and the reader at an offset. */
const PRIMITIVES = {
  bool: [1, (view, at) => view.getUint8(at) !== 0],
  byte: [1, (view, at) => view.getUint8(at)],
  char: [1, (view, at) => view.getUint8(at)],
  uint8: [1, (view, at) => view.getUint8(at)],
  int8: [1, (view, at) => view.getInt8(at)],
  uint16: [2, (view, at, little) => view.getUint16(at, little)],
  int16: [2, (view, at, little) => view.getInt16(at, little)],
  uint32: [4, (view, at, little) => view.getUint32(at, little)],
  int32: [4, (view, at, little) => view.getInt32(at, little)],
  float32: [4, (view, at, little) => view.getFloat32(at, little)],
  float64: [8, (view, at, little) => view.getFloat64(at, little)],
  uint64: [8, (view, at, little) =>
    view.getUint32(at + (little ? 4 : 0), little) * HALF + view.getUint32(at + (little ? 0 : 4), little)],
  int64: [8, (view, at, little) =>
    view.getInt32(at + (little ? 4 : 0), little) * HALF + view.getUint32(at + (little ? 0 : 4), little)],
};

/** Position of the next value in a message. Alignment counts from the end of the encapsulation. */
class Cursor {
  constructor(buffer, offset) {
    this.view = new DataView(buffer);
    this.little = (this.view.getUint8(offset + 1) & 1) === 1;
    this.start = offset + 4;
    this.at = this.start;
  }

  align(size) {
    const over = (this.at - this.start) % size;
    if (over !== 0) this.at += size - over;
  }
}

/** The last part of a name: `squall_msgs/msg/Nav` and `Nav` are equal. */
const short = (name) => name.slice(name.lastIndexOf('/') + 1);

/** The fields and constants of a definition. */
export function parse(text) {
  const fields = [];
  const constants = {};
  for (const line of text.split('\n')) {
    const bare = line.replace(/#.*$/, '').trim();
    if (bare === '') continue;
    const constant = /^(\S+)\s+([A-Za-z]\w*)\s*=\s*(.+)$/.exec(bare);
    if (constant) {
      const number = Number(constant[3]);
      constants[constant[2]] = Number.isNaN(number) ? constant[3] : number;
      continue;
    }
    const field = /^([\w/]+)(?:<=\d+)?(\[(<=)?(\d*)\])?\s+(\w+)/.exec(bare);
    if (!field) throw new Error(`invalid line in a message definition: ${bare}`);
    const [, type, list, bound, count] = field;
    const fixed = list && !bound && count !== '' ? Number(count) : null;
    fields.push({ type, name: field[5], list: Boolean(list), fixed });
  }
  return { fields, constants };
}

function readString(cursor) {
  cursor.align(4);
  const length = cursor.view.getUint32(cursor.at, cursor.little);
  const from = cursor.at + 4;
  cursor.at = from + length;
  if (cursor.at > cursor.view.byteLength) throw new RangeError('a string extends past the end');
  // The length includes the terminating zero.
  const bytes = new Uint8Array(cursor.view.buffer, from, Math.max(0, length - 1));
  return new TextDecoder().decode(bytes);
}

function primitiveReader([size, get]) {
  return (cursor) => {
    cursor.align(size);
    const value = get(cursor.view, cursor.at, cursor.little);
    cursor.at += size;
    return value;
  };
}

function listReader(read, fixed) {
  return (cursor, old) => {
    let length = fixed;
    if (fixed === null) {
      cursor.align(4);
      length = cursor.view.getUint32(cursor.at, cursor.little);
      cursor.at += 4;
      if (length > cursor.view.byteLength - cursor.at) throw new RangeError('a list extends past the end');
    }
    const list = Array.isArray(old) ? old : [];
    for (let i = 0; i < length; i++) list[i] = read(cursor, list[i]);
    list.length = length;
    return list;
  };
}

function structReader(definition, readerFor) {
  const names = definition.fields.map((field) => field.name);
  const readers = definition.fields.map((field) => {
    const one = readerFor(field.type);
    return field.list ? listReader(one, field.fixed) : one;
  });
  return (cursor, old) => {
    const message = old ?? {};
    for (let i = 0; i < names.length; i++) message[names[i]] = readers[i](cursor, message[names[i]]);
    return message;
  };
}

/**
 * Returns a function that reads a message `name` from `(buffer, offset, old)`, with its encapsulation. If `old`, an
 * earlier message, is given, its objects and lists are overwritten instead of recreated.
 */
export function readerOf(definitions, name) {
  const texts = new Map(Object.entries(definitions).map(([known, text]) => [short(known), text]));
  const made = new Map();
  const readerFor = (type) => {
    if (type === 'string') return readString;
    if (type in PRIMITIVES) return primitiveReader(PRIMITIVES[type]);
    const key = short(type);
    if (!made.has(key)) {
      if (!texts.has(key)) throw new Error(`no definition of ${type}`);
      made.set(key, structReader(parse(texts.get(key)), readerFor));
    }
    return made.get(key);
  };
  const read = readerFor(name);
  return (buffer, offset = 0, old = undefined) => read(new Cursor(buffer, offset), old);
}
