// SPDX-License-Identifier: MIT
import { colourOf } from './theme.js';

/** Runs of neighbours that have a value and a sigma: points of time, lower and upper edge. */
function stretches(rows, line) {
  const found = [[]];
  for (const row of rows) {
    const value = line.read(row);
    const sigma = line.sigma(row);
    if (value === null || sigma === null) found.push([]);
    else found.at(-1).push([row.time, value - sigma, value + sigma]);
  }
  return found.filter((points) => points.length > 1);
}

/** The sigma that an estimator states, to both sides of its line. */
export function drawSigmaBand(plot, rows, line) {
  const { ctx, bbox } = plot;
  const x = (time) => plot.valToPos(time, 'x', true);
  const y = (value) => plot.valToPos(value, 'y', true);
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.beginPath();
  for (const points of stretches(rows, line)) {
    points.forEach(([time, low], i) => (i === 0 ? ctx.moveTo(x(time), y(low)) : ctx.lineTo(x(time), y(low))));
    for (const [time, , high] of points.toReversed()) ctx.lineTo(x(time), y(high));
    ctx.closePath();
  }
  ctx.globalAlpha = 0.22;
  ctx.fillStyle = colourOf(line.style.colour);
  ctx.fill();
  ctx.restore();
}
