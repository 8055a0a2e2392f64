// SPDX-License-Identifier: MIT
import uPlot from 'uplot';
import { drawHatching } from './hatching.js';
import { colourOf, lines } from './theme.js';
import { byId, clock, fixed, say, unknown } from './text.js';

const font = '12px system-ui, sans-serif';
const swatch = 'http://www.w3.org/2000/svg';

/** A short piece of a line, as in the plot. */
function sample(key) {
  const svg = document.createElementNS(swatch, 'svg');
  svg.setAttribute('width', '20');
  svg.setAttribute('height', '8');
  svg.setAttribute('aria-hidden', 'true');
  const line = document.createElementNS(swatch, 'line');
  for (const [name, value] of Object.entries({ x1: 0, x2: 20, y1: 4, y2: 4, class: key,
    'stroke-width': lines[key].width + 0.5, 'stroke-dasharray': lines[key].dash.join(' ') || 'none' })) {
    line.setAttribute(name, value);
  }
  svg.append(line);
  return svg;
}

/** One plot over the last minute. `read(row)` gives one value, or null, for each of `keys`. */
export class Strip {
  /** `limits(rows, values)`: lowest and highest of the vertical axis. */
  constructor(id, { keys, read, limits, digits, unit = '', sign = true, axis = false, ticks }) {
    this.section = byId(id);
    this.box = this.section.querySelector('.plot');
    this.keys = keys;
    this.read = read;
    this.limits = limits;
    this.digits = digits;
    this.ticks = ticks;
    this.unit = unit;
    this.sign = sign;
    this.rows = [];
    this.spans = [];
    this.window = [0, 60];
    this.vertical = [-1, 1];
    this.makeLegend();
    this.plot = new uPlot(this.options(axis), [[], ...keys.map(() => [])], this.box);
    this.box.strip = this.plot;  // for whoever asks the page for its data
    new ResizeObserver(() => this.resize()).observe(this.box);
    this.resize();
  }

  makeLegend() {
    const legend = this.section.querySelector('.legend');
    this.legend = this.keys.map((key) => {
      const item = document.createElement('span');
      const value = document.createElement('output');
      const name = document.createElement('span');
      name.textContent = lines[key].name;
      item.append(sample(key), name, value);
      item.hidden = false;
      legend.append(item);
      return { item, value };
    });
  }

  options(axis) {
    const shared = { font, stroke: () => colourOf('quiet'), grid: { stroke: () => colourOf('line'), width: 1 },
      ticks: { stroke: () => colourOf('line'), width: 1, size: 4 } };
    return {
      width: 300,
      height: 100,
      legend: { show: false },
      padding: [7, 18, axis ? 0 : 4, 0],
      cursor: { sync: { key: 'time' }, drag: { x: false, y: false }, points: { size: 6 } },
      scales: { x: { time: false, range: () => this.window }, y: { range: () => this.vertical } },
      axes: [
        { ...shared, space: 60, size: axis ? 22 : 0, ticks: { ...shared.ticks, show: axis },
          values: (plot, splits) => splits.map((at) => (axis ? clock(at) : '')) },
        { ...shared, size: 44, gap: 3, space: 26, ...(this.ticks && { splits: () => this.ticks }),
          values: (plot, splits) => splits.map((at) => fixed(at, splits.some((other) => other % 1 !== 0) ? 1 : 0)) },
      ],
      series: [{}, ...this.keys.map((key) => ({ stroke: () => colourOf(key), width: lines[key].width, dash: lines[key].dash,
        spanGaps: false, points: { show: false } }))],
      hooks: { drawClear: [(plot) => drawHatching(plot, this.spans)], drawAxes: [(plot) => this.drawZero(plot)],
        setCursor: [() => this.showCursor()] },
    };
  }

  drawZero(plot) {
    const [low, high] = this.vertical;
    if (low >= 0 || high <= 0) return;
    const { ctx, bbox } = plot;
    const y = Math.round(plot.valToPos(0, 'y', true)) + 0.5;
    ctx.save();
    ctx.strokeStyle = colourOf('quiet');
    ctx.lineWidth = 1;
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    ctx.restore();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (width > 60 && height > 30) this.plot.setSize({ width, height });
  }

  draw(rows, spans, window) {
    this.rows = rows;
    this.spans = spans;
    this.window = window;
    const columns = this.keys.map(() => []);
    for (const row of rows) this.read(row).forEach((value, i) => columns[i].push(value));
    this.vertical = this.limits(rows, columns);
    this.plot.setData([rows.map((row) => row.time), ...columns]);
    this.showCursor();
  }

  /** Values under the cursor, or the newest. */
  showCursor() {
    const at = this.plot.cursor.idx ?? this.rows.length - 1;
    const row = this.rows[at];
    const values = row === undefined ? this.keys.map(() => null) : this.read(row);
    this.legend.forEach(({ value }, i) => {
      say(value, values[i] === null ? unknown : `${fixed(values[i], this.digits, { sign: this.sign })}${this.unit}`);
    });
  }

  redraw() {
    this.plot.redraw(false, true);
  }
}
