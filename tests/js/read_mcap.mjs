// SPDX-License-Identifier: Apache-2.0
// A log's channels (with their schemas) and messages, in the order of their time.
import fs from "node:fs";

import { McapIndexedReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";

export async function readLog(file) {
  const bytes = fs.readFileSync(file);
  const reader = await McapIndexedReader.Initialize({
    readable: {
      size: async () => BigInt(bytes.length),
      read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
    },
    decompressHandlers: await loadDecompressHandlers(),
  });
  const channels = new Map();
  for (const [id, { topic, schemaId }] of reader.channelsById)
    channels.set(id, { id, topic, schema: reader.schemasById.get(schemaId) });
  const messages = [];
  for await (const message of reader.readMessages()) messages.push(message);
  return { channels, messages };
}
