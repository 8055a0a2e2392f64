// SPDX-License-Identifier: MIT
import { paletteNames, paletteTable } from './palette.js';
import { AutoRange } from './range.js';
import { decodeImage, drawImage } from './temperatures.js';
import { byId, fixed, number, plain, say } from './text.js';

const width = 32;
const height = 24;
const describedEvery = 10_000;  // ms between texts for those who do not see the image

const freshTexts = { both: 'all pixels new', half: 'half of the pixels new', repeated: '▲ repeated' };

export class ThermalImage {
  constructor() {
    this.canvas = byId('image');
    this.range = new AutoRange();
    this.palette = 0;
    this.inverted = false;
    this.temperatures = null;
    this.absent = false;
    this.described = -Infinity;
    this.pointer = null;
    this.canvas.addEventListener('pointermove', (event) => {
      const box = this.canvas.getBoundingClientRect();
      const at = (place, size, cells) => Math.min(cells - 1, Math.max(0, Math.floor((place / size) * cells)));
      this.pointer = [at(event.clientX - box.left, box.width, width), at(event.clientY - box.top, box.height, height)];
      this.showSpot();
    });
    this.canvas.addEventListener('pointerleave', () => {
      this.pointer = null;
      this.showSpot();
    });
    this.showPalette();
  }

  clear() {
    this.temperatures = null;
    this.absent = false;
    if (!this.range.locked) this.range.clear();
    this.described = -Infinity;
  }

  take(message) {
    const temperatures = decodeImage(message.pixels, width * height);
    if (temperatures !== null) this.show(temperatures, number(message.time_s));
  }

  /** `temperatures`: of all pixels, NaN where there is none; `time`: s, by which the colours' range follows. */
  show(temperatures, time) {
    const known = temperatures.filter(Number.isFinite);
    if (known.length === 0) {
      this.showNone();
      return;
    }
    this.temperatures = temperatures;
    this.absent = false;
    this.range.follow(known, time);
  }

  /** A camera that is missing: its last image must not look like a present one. */
  showNone() {
    this.clear();
    this.canvas.getContext('2d').clearRect(0, 0, width, height);
    this.canvas.setAttribute('aria-label', 'Thermal image: no image');
    this.absent = true;
    this.freshness(null);
    this.showSpot();
  }

  freshness(fresh) {
    const badge = byId('fresh');
    if (this.absent) {
      say(badge, 'no image');
      badge.dataset.fresh = 'unknown';
      return;
    }
    say(badge, freshTexts[fresh] ?? (plain(fresh, 40) || 'freshness unknown'));
    badge.dataset.fresh = freshTexts[fresh] ? fresh : 'unknown';
  }

  nextPalette() {
    this.palette = (this.palette + 1) % paletteNames.length;
    this.showPalette();
  }

  invert() {
    this.inverted = !this.inverted;
    this.showPalette();
  }

  lock() {
    this.range.locked = !this.range.locked;
    this.draw();
  }

  showPalette() {
    this.table = paletteTable(paletteNames[this.palette], this.inverted);
    say(byId('colours'), paletteNames[this.palette]);
    const context = byId('scale').getContext('2d');
    const pixels = context.createImageData(256, 1);
    for (let i = 0; i < 256; ++i) {
      pixels.data.set(this.table.subarray(i * 3, i * 3 + 3), i * 4);
      pixels.data[i * 4 + 3] = 255;
    }
    context.putImageData(pixels, 0, 0);
    this.draw();
  }

  draw() {
    const { low, high, locked } = this.range;
    say(byId('cold'), low === null ? '–' : `${fixed(low, 1)} °C`);
    say(byId('hot'), high === null ? '–' : `${fixed(high, 1)} °C`);
    say(byId('range'), locked ? '■ range locked' : 'auto range');
    if (this.temperatures === null) return;
    drawImage(this.canvas, this.temperatures, this.table, this.range);
    this.showSpot();
    this.describe();
  }

  showSpot() {
    if (this.pointer === null || this.temperatures === null) {
      say(byId('spot'), '');
      return;
    }
    const [x, y] = this.pointer;
    say(byId('spot'), `row ${y}, column ${x}: ${fixed(this.temperatures[y * width + x], 1)} °C`);
  }

  describe() {
    if (Date.now() - this.described < describedEvery) return;
    this.described = Date.now();
    const first = this.temperatures.findIndex(Number.isFinite);
    let coldest = first;
    let hottest = first;
    this.temperatures.forEach((value, i) => {
      if (value < this.temperatures[coldest]) coldest = i;
      if (value > this.temperatures[hottest]) hottest = i;
    });
    const third = (place, size, names) => names[Math.min(2, Math.floor((place / size) * 3))];
    const row = Math.floor(hottest / width);
    const where = `${third(row, height, ['top', 'middle', 'bottom'])} ${third(hottest % width, width, ['left', 'centre', 'right'])}`;
    this.canvas.setAttribute('aria-label', `Thermal image, ${fixed(this.temperatures[coldest], 1)} to ` +
      `${fixed(this.temperatures[hottest], 1)} °C, hottest at the ${where}; colours from ${fixed(this.range.low, 1)} to ` +
      `${fixed(this.range.high, 1)} °C`);
  }
}
