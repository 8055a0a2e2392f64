// SPDX-License-Identifier: MIT
import { colourOf } from './theme.js';

/** Spans of time of excluded frames, neighbours as one. Each frame reaches half way to the next. */
export function excludedSpans(rows) {
  const spans = [];
  rows.forEach((row, i) => {
    if (row.gap || row.counted) return;
    const before = rows[i - 1];
    const after = rows[i + 1];
    const reach = (other) => (other === undefined ? row.time : (row.time + other.time) / 2);
    const begin = before === undefined ? row.begin ?? row.time : reach(before);
    const end = after === undefined ? row.end ?? row.time : reach(after);
    const last = spans.at(-1);
    if (last !== undefined && last[1] >= begin) last[1] = end;
    else spans.push([begin, end]);
  });
  return spans;
}

/** Draws them under the lines of a plot. */
export function drawHatching(plot, spans) {
  const { ctx, bbox } = plot;
  const step = 7 * devicePixelRatio;
  ctx.save();
  ctx.beginPath();
  for (const [begin, end] of spans) {
    const left = plot.valToPos(begin, 'x', true);
    const right = plot.valToPos(end, 'x', true);
    if (right > bbox.left && left < bbox.left + bbox.width) ctx.rect(left, bbox.top, Math.max(1, right - left), bbox.height);
  }
  ctx.fillStyle = colourOf('excluded');
  ctx.fill();
  ctx.clip();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.beginPath();
  // Fixed to the picture, not to the time: stripes that moved with every frame would flicker.
  for (let x = bbox.left - bbox.height; x < bbox.left + bbox.width; x += step) {
    ctx.moveTo(x, bbox.top + bbox.height);
    ctx.lineTo(x + bbox.height, bbox.top);
  }
  ctx.strokeStyle = colourOf('excluded-line');
  ctx.lineWidth = devicePixelRatio;
  ctx.stroke();
  ctx.restore();
}
