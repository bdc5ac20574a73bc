// SPDX-License-Identifier: Apache-2.0
// Reads protobuf messages by the FileDescriptorSet that a channel brings with it. 64-bit integers become numbers (exact up
// to 2^53), enumerations the names of their values, bytes a view into the message. Absent fields have proto3's defaults.

const utf8 = new TextDecoder();

// Types of FieldDescriptorProto.
const TYPE = { double: 1, float: 2, int64: 3, uint64: 4, int32: 5, fixed64: 6, fixed32: 7, bool: 8, string: 9 };
Object.assign(TYPE, {
  message: 11,
  bytes: 12,
  uint32: 13,
  enum: 14,
  sfixed32: 15,
  sfixed64: 16,
  sint32: 17,
  sint64: 18,
});

class Reader {
  constructor(bytes) {
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.at = 0;
  }

  // Both halves of a varint, as unsigned 32-bit integers.
  halves() {
    let low = 0;
    let high = 0;
    for (let shift = 0; shift < 70; shift += 7) {
      if (this.at >= this.bytes.length) throw new RangeError("the message ends within a number");
      const byte = this.bytes[this.at++];
      const part = byte & 0x7f;
      if (shift < 28) low |= part << shift;
      else if (shift === 28) {
        low |= part << 28;
        high |= part >> 4;
      } else high |= part << (shift - 32);
      if (byte < 0x80) return [low >>> 0, high >>> 0];
    }
    throw new RangeError("a number of more than ten bytes");
  }

  unsigned() {
    const [low, high] = this.halves();
    return high * 4294967296 + low;
  }

  signed() {
    const [low, high] = this.halves();
    return (high | 0) * 4294967296 + low;
  }

  zigzag() {
    const [low, high] = this.halves();
    const half = high * 2147483648 + (low >>> 1);
    return low & 1 ? -half - 1 : half;
  }

  step(size) {
    const from = this.at;
    if (!(size >= 0 && from + size <= this.bytes.length)) throw new RangeError("the message ends within a field");
    this.at = from + size;
    return from;
  }

  piece() {
    const size = this.unsigned();
    const from = this.step(size);
    return this.bytes.subarray(from, from + size);
  }

  skip(wire) {
    if (wire === 0) this.halves();
    else if (wire === 1) this.step(8);
    else if (wire === 2) this.step(this.unsigned());
    else if (wire === 5) this.step(4);
    else throw new RangeError(`wire type ${wire} is not known`);
  }
}

const READ = {
  [TYPE.double]: (r) => r.view.getFloat64(r.step(8), true),
  [TYPE.float]: (r) => r.view.getFloat32(r.step(4), true),
  [TYPE.int64]: (r) => r.signed(),
  [TYPE.uint64]: (r) => r.unsigned(),
  [TYPE.int32]: (r) => r.halves()[0] | 0,
  [TYPE.uint32]: (r) => r.halves()[0],
  [TYPE.fixed64]: (r) => Number(r.view.getBigUint64(r.step(8), true)),
  [TYPE.sfixed64]: (r) => Number(r.view.getBigInt64(r.step(8), true)),
  [TYPE.fixed32]: (r) => r.view.getUint32(r.step(4), true),
  [TYPE.sfixed32]: (r) => r.view.getInt32(r.step(4), true),
  [TYPE.bool]: (r) => r.unsigned() !== 0,
  [TYPE.string]: (r) => utf8.decode(r.piece()),
  [TYPE.bytes]: (r) => r.piece(),
  [TYPE.sint32]: (r) => r.zigzag(),
  [TYPE.sint64]: (r) => r.zigzag(),
};

const WIRE_OF = { [TYPE.double]: 1, [TYPE.fixed64]: 1, [TYPE.sfixed64]: 1 };
Object.assign(WIRE_OF, { [TYPE.float]: 5, [TYPE.fixed32]: 5, [TYPE.sfixed32]: 5 });
Object.assign(WIRE_OF, { [TYPE.string]: 2, [TYPE.bytes]: 2, [TYPE.message]: 2 });

function defaultOf({ type, repeated, of }) {
  if (repeated) return [];
  if (type === TYPE.message || type === TYPE.bytes) return null;
  if (type === TYPE.string) return "";
  if (type === TYPE.bool) return false;
  return type === TYPE.enum ? of.names.get(0) || "" : 0;
}

function valueOf(reader, { type, of }) {
  if (type === TYPE.message) return decode(of, reader.piece());
  if (type !== TYPE.enum) return READ[type](reader);
  const number = READ[TYPE.int32](reader);
  return of.names.get(number) || String(number);
}

// Throws RangeError when the bytes are no such message.
function decode(type, bytes) {
  const message = {};
  for (const field of type.fields.values()) message[field.name] = defaultOf(field);
  const reader = new Reader(bytes);
  while (reader.at < bytes.length) {
    const key = reader.unsigned();
    const wire = key & 7;
    const field = type.fields.get(Math.floor(key / 8));
    const own = field && (WIRE_OF[field.type] || 0);
    if (field && field.repeated && wire === 2 && own !== 2) {
      const end = reader.unsigned() + reader.at;
      if (!(end <= bytes.length)) throw new RangeError("the message ends within a list");
      while (reader.at < end) message[field.name].push(valueOf(reader, field));
    } else if (!field || wire !== own) reader.skip(wire);
    else if (field.repeated) message[field.name].push(valueOf(reader, field));
    else message[field.name] = valueOf(reader, field);
  }
  return message;
}

// The messages of descriptor.proto, as far as they are needed to read a FileDescriptorSet.
function makeType(...fields) {
  return {
    fields: new Map(fields.map(([number, name, type, repeated, of]) => [number, { name, type, repeated, of }])),
  };
}
const VALUE = makeType([1, "name", TYPE.string], [2, "number", TYPE.int32]);
const ENUM = makeType([1, "name", TYPE.string], [2, "value", TYPE.message, true, VALUE]);
const FIELD = makeType(
  [1, "name", TYPE.string],
  [3, "number", TYPE.int32],
  [4, "label", TYPE.int32],
  [5, "type", TYPE.int32],
  [6, "type_name", TYPE.string],
);
const MESSAGE = makeType(
  [1, "name", TYPE.string],
  [2, "field", TYPE.message, true, FIELD],
  [4, "enum_type", TYPE.message, true, ENUM],
);
MESSAGE.fields.set(3, { name: "nested_type", type: TYPE.message, repeated: true, of: MESSAGE });
const FILE = makeType(
  [2, "package", TYPE.string],
  [4, "message_type", TYPE.message, true, MESSAGE],
  [5, "enum_type", TYPE.message, true, ENUM],
);
const SET = makeType([1, "file", TYPE.message, true, FILE]);
const REPEATED = 3; // of FieldDescriptorProto.Label

// A function from bytes to a message of the type `name`. `schema`: the bytes of a FileDescriptorSet.
export function decoder(schema, name) {
  const types = new Map();
  const waiting = [];
  const addEnum = (path, one) =>
    types.set(`${path}.${one.name}`, { names: new Map(one.value.map((v) => [v.number, v.name])) });
  const add = (path, message) => {
    const full = `${path}.${message.name}`;
    const type = { fields: new Map() };
    types.set(full, type);
    for (const f of message.field) {
      const field = { name: f.name, type: f.type, repeated: f.label === REPEATED, of: null };
      type.fields.set(f.number, field);
      if (f.type_name) waiting.push(() => (field.of = types.get(f.type_name)));
    }
    message.enum_type.forEach((one) => addEnum(full, one));
    message.nested_type.forEach((one) => add(full, one));
  };
  for (const file of decode(SET, schema).file) {
    const path = file.package ? `.${file.package}` : "";
    file.enum_type.forEach((one) => addEnum(path, one));
    file.message_type.forEach((one) => add(path, one));
  }
  waiting.forEach((resolve) => resolve());
  const type = types.get(`.${name}`);
  if (!type) throw new RangeError(`the schema has no message ${name}`);
  return (bytes) => decode(type, bytes);
}
