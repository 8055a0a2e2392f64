// SPDX-License-Identifier: MIT
// What @mcap/core finds in a file, as JSON on standard output: of each topic its schema, the times of its messages and
// their data, as SHA-256 of all one after another; /camera also of the pixels.
// Usage: node read.mjs FILE
import { createHash } from "node:crypto";
import { open } from "node:fs/promises";

import { McapIndexedReader } from "@mcap/core";
import { decompress } from "fzstd";

const file = await open(process.argv[2]);
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, size) => {
    const bytes = new Uint8Array(Number(size));
    const { bytesRead } = await file.read(bytes, 0, bytes.length, Number(offset));
    if (bytesRead !== bytes.length) throw new Error(`the file ends after ${bytesRead} of ${bytes.length} bytes`);
    return bytes;
  },
};
const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
const topics = {};
for (const { id, topic, schemaId, messageEncoding } of reader.channelsById.values())
  topics[topic] = {
    schema: reader.schemasById.get(schemaId).name,
    encoding: messageEncoding,
    counted: Number(reader.statistics.channelMessageCounts.get(id)),
    log_times: [],
    publish_times: [],
    data: createHash("sha256"),
    pixels: createHash("sha256"),
  };
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const { topic } = reader.channelsById.get(message.channelId);
  const found = topics[topic];
  found.log_times.push(String(message.logTime));
  found.publish_times.push(String(message.publishTime));
  found.data.update(message.data);
  if (topic === "/camera")
    found.pixels.update(Buffer.from(JSON.parse(new TextDecoder().decode(message.data)).data, "base64"));
}
for (const found of Object.values(topics)) {
  found.data = found.data.digest("hex");
  found.pixels = found.pixels.digest("hex");
}
const compressions = [...new Set(reader.chunkIndexes.map((chunk) => chunk.compression))];
console.log(JSON.stringify({ compressions, chunks: reader.chunkIndexes.length, topics }));
