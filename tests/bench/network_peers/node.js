// SPDX-License-Identifier: MIT
// onnxruntime-node's side of network_peers.sh: what a call from JavaScript costs; answers as worker.h says.
//   node node.js NODE_MODULES MODEL.onnx      (Nf = 3, Nr = 1, fusion)
"use strict";
const path = require("path");
const readline = require("readline");

const [folder, model] = process.argv.slice(2);
const ort = require(path.join(folder, "onnxruntime-node"));
const pixels = 3 * 24 * 32;

// The values do not matter to the time: any numbers of the same size as the other workers'.
const frames = Float32Array.from({ length: pixels }, (_, i) => Math.sin(i * 12.9898) * 1.7);
const feeds = {
  frames: new ort.Tensor("float32", frames, [1, 3, 24, 32]),
  gyro: new ort.Tensor("float32", [0.3], [1, 1]),
};

function median(values) {
  return values.sort((a, b) => a - b)[values.length >> 1];
}

async function answer(session, groups, calls) {
  const processor = [];
  const wall = [];
  for (let group = 0; group < groups; ++group) {
    const used = process.cpuUsage();
    const begin = process.hrtime.bigint();
    for (let i = 0; i < calls; ++i) await session.run(feeds);
    wall.push(Number(process.hrtime.bigint() - begin) * 1e-3 / calls);
    const now = process.cpuUsage(used);
    processor.push((now.user + now.system) / calls);
  }
  console.log(JSON.stringify({ processor_us: median(processor), wall_us: median(wall) }));
}

async function main() {
  const session = await ort.InferenceSession.create(model, {
    intraOpNumThreads: 1, interOpNumThreads: 1, graphOptimizationLevel: "all",
  });
  for await (const line of readline.createInterface({ input: process.stdin })) {
    const [, groups, calls] = line.split(" ");
    await answer(session, Number(groups), Number(calls));
  }
}

main();
