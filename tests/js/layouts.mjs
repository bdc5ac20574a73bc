// SPDX-License-Identifier: Apache-2.0
// Checks that the log has every stream and field that a layout shows, and that every panel is placed once.
import assert from "node:assert/strict";
import fs from "node:fs";

// The value at `path` ("arm.q[0]") in a message; undefined if there is no such field.
function lookUp(message, path) {
  let value = message;
  for (const step of path.split(".")) {
    const [, name, index] = step.match(/^(\w+)(?:\[(\d+)\])?$/);
    value = value?.[name];
    if (index !== undefined) {
      value = value?.[Number(index)];
    }
  }
  return value;
}

// `byTopic`: topic to [{data}] with decoded messages. Returns the number of checked fields.
export function checkLayouts(folder, byTopic) {
  let looked = 0;
  const check = (topic, field, where) => {
    const messages = byTopic.get(topic) ?? [];
    const message = messages[Math.floor(messages.length / 2)]?.data;
    assert.ok(message, `${where}: ${topic} is not in the log`);
    if (field) {
      assert.notEqual(lookUp(message, field), undefined, `${where}: ${topic} has no ${field}`);
    }
    ++looked;
  };
  const foxglove = JSON.parse(fs.readFileSync(`${folder}/foxglove.json`, "utf8"));
  for (const [panel, config] of Object.entries(foxglove.configById)) {
    for (const { value } of config.paths ?? []) {
      const [, topic, field] = value.match(/^([^.]+)\.(.+)$/);
      check(topic, field, panel);
    }
    const named = [
      config.topicToRender,
      config.imageMode?.imageTopic,
      config.imageMode?.calibrationTopic,
      ...Object.keys(config.imageMode?.annotations ?? {}),
      ...Object.keys(config.topics ?? {}),
    ];
    for (const topic of named.filter(Boolean)) {
      check(topic, "", panel);
    }
  }
  const placed = [];
  (function walk(node) {
    if (typeof node === "string") {
      placed.push(node);
    } else {
      walk(node.first);
      walk(node.second);
    }
  })(foxglove.layout);
  assert.deepEqual(placed.sort(), Object.keys(foxglove.configById).sort());

  const curves = [...fs.readFileSync(`${folder}/plotjuggler.xml`, "utf8").matchAll(/<curve [^>]*name="([^"]+)"/g)];
  assert.ok(curves.length > 10);
  for (const [, curve] of curves) {
    const topic = [...byTopic.keys()]
      .filter((name) => curve.startsWith(`${name}/`))
      .sort()
      .at(-1);
    assert.ok(topic, `PlotJuggler's ${curve}: no such stream`);
    check(topic, curve.slice(topic.length + 1).replaceAll("/", "."), "PlotJuggler");
  }
  return looked;
}
