// SPDX-License-Identifier: MIT
import { colourOf } from './theme.js';

const widest = 28;  // px

/** Bars over the whole width of a canvas. Each: `value` of `full`, a colour's name, a `mark` (height) or null; `labels` below. */
export function drawBars(canvas, bars, labels, full) {
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  if (width === 0 || height === 0) return;
  const sharp = devicePixelRatio;
  if (canvas.width !== Math.round(width * sharp) || canvas.height !== Math.round(height * sharp)) {
    canvas.width = Math.round(width * sharp);
    canvas.height = Math.round(height * sharp);
  }
  const context = canvas.getContext('2d');
  context.setTransform(sharp, 0, 0, sharp, 0, 0);
  context.clearRect(0, 0, width, height);
  const floor = height - 15;
  const step = width / Math.max(1, bars.length);
  const gap = Math.max(step > 5 ? 1.5 : 0.5, step - widest);
  const heightOf = (value) => (full > 0 ? Math.min(1, value / full) * (floor - 2) : 0);
  context.fillStyle = colourOf('line');
  context.fillRect(0, floor, width, 1);
  bars.forEach((bar, i) => {
    context.fillStyle = colourOf(bar.colour);
    context.fillRect(i * step + gap / 2, floor - heightOf(bar.value), step - gap, heightOf(bar.value));
    if (bar.mark === null) return;
    context.fillStyle = colourOf('ink');
    context.fillRect(i * step + gap / 2, floor - heightOf(bar.mark), step - gap, 1.5);
  });
  context.fillStyle = colourOf('quiet');
  context.font = '11px system-ui, sans-serif';
  for (const { text, at } of labels) {
    const half = context.measureText(text).width / 2;
    const x = Math.min(width - half, Math.max(half, at * width));
    context.fillText(text, x - half, height - 3);
  }
}
