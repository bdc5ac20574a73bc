// SPDX-License-Identifier: Apache-2.0
// Compares the schemas in a log with Foxglove's own definitions.
import assert from "node:assert/strict";
import { createRequire } from "node:module";

import protobuf from "protobufjs";

const { foxgloveEnumSchemas, foxgloveMessageSchemas, generateProto } = createRequire(import.meta.url)(
  "@foxglove/schemas/internal",
);

// Foxglove's definitions as one set of types. Foxglove has one file per message; here they share one root.
function official() {
  const root = new protobuf.Root();
  const common = protobuf.common.get("google/protobuf/timestamp.proto");
  root.addJSON(common.nested);
  root.addJSON(protobuf.common.get("google/protobuf/duration.proto").nested);
  for (const schema of Object.values(foxgloveMessageSchemas)) {
    const enums = Object.values(foxgloveEnumSchemas).filter((e) => e.parentSchemaName === schema.name);
    protobuf.parse(generateProto(schema, enums).replace(/^import.*$/gm, ""), root, { keepCase: true });
  }
  root.resolveAll();
  return root;
}

const shapeOf = (type) =>
  Object.fromEntries(
    type.fieldsArray
      .map((f) => {
        f.resolve();
        const name = f.resolvedType ? f.resolvedType.fullName : f.type;
        return [f.id, `${f.name.replaceAll("_", "").toLowerCase()} ${f.repeated ? "repeated " : ""}${name}`];
      })
      .sort(([a], [b]) => a - b),
  );

// `types`: message types by number. Each type of package foxglove, and each type that it contains, must equal the
// official one. Returns the number of compared types.
export function compareWithOfficial(types) {
  const root = official();
  const seen = new Set();
  const compare = (type) => {
    if (seen.has(type.fullName) || !type.fullName.startsWith(".foxglove.")) {
      return;
    }
    seen.add(type.fullName);
    assert.deepEqual(shapeOf(type), shapeOf(root.lookupType(type.fullName)), type.fullName);
    for (const field of type.fieldsArray) {
      if (field.resolvedType?.fieldsArray) {
        compare(field.resolvedType);
      } else if (field.resolvedType) {
        assert.deepEqual({ ...field.resolvedType.values }, { ...root.lookupEnum(field.resolvedType.fullName).values });
      }
    }
  };
  for (const type of types.values()) {
    compare(type);
  }
  assert.ok(seen.size > 20, `only ${seen.size} messages were compared`);
  return seen.size;
}
