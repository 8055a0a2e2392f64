// SPDX-License-Identifier: MIT

const noValue = -32768;

/** Temperatures in degC of little-endian hundredths, NaN where there is none; null for what is not `count` of them. */
export function decodeImage(base64, count) {
  if (typeof base64 !== 'string') return null;
  let raw;
  try {
    raw = atob(base64);
  } catch {
    return null;
  }
  if (raw.length !== count * 2) return null;
  const temperatures = new Float32Array(count);
  for (let i = 0; i < count; ++i) {
    const bits = raw.charCodeAt(2 * i) | (raw.charCodeAt(2 * i + 1) << 8);
    const hundredths = (bits << 16) >> 16;
    temperatures[i] = hundredths === noValue ? NaN : hundredths / 100;
  }
  return temperatures;
}

/** Draws them into a canvas of as many pixels: `table` has 256 colours from `low` to `high`, and NaN is transparent. */
export function drawImage(canvas, temperatures, table, { low, high }) {
  const context = canvas.getContext('2d');
  const pixels = context.createImageData(canvas.width, canvas.height);
  const scale = 255 / (high - low);
  temperatures.forEach((value, i) => {
    if (Number.isNaN(value)) return;
    const step = Math.min(255, Math.max(0, Math.round((value - low) * scale)));
    pixels.data.set(table.subarray(step * 3, step * 3 + 3), i * 4);
    pixels.data[i * 4 + 3] = 255;
  });
  context.putImageData(pixels, 0, 0);
}
