// SPDX-License-Identifier: MIT
import uPlot from 'uplot';
import { drawHatching } from './hatching.js';
import { drawSigmaBand } from './sigma_band.js';
import { clock, byId, fixed } from './text.js';
import { colourOf } from './theme.js';

const font = '12px system-ui, sans-serif';
const isShown = ({ estimator }) => estimator === undefined || estimator.shown;

/**
 * One plot over the last minute. Its lines: `read(row)` gives a value or null, `sigma(row)` that of the band, `style` how it is drawn,
 * `estimator` whose it is; without one it is always shown.
 */
export class Strip {
  /**
   * `limits(rows, columns)`: lowest and highest of the vertical axis, from the lines that are shown; `onCursor()` when it moved; `pointer`: the
   * cursor follows it.
   */
  constructor(id, { limits, axis = false, ticks, onCursor = () => {}, pointer = true }) {
    this.section = byId(id);
    this.box = this.section.querySelector('.plot');
    this.limits = limits;
    this.axis = axis;
    this.ticks = ticks;
    this.onCursor = onCursor;
    this.pointer = pointer;
    this.setLines([]);
    new ResizeObserver(() => this.resize()).observe(this.box);
  }

  /** Other lines, in an empty plot. */
  setLines(lines) {
    this.lines = lines;
    this.highlighted = null;
    this.rows = [];
    this.spans = [];
    this.window = [0, 60];
    this.vertical = [-1, 1];
    this.plot?.destroy();
    this.plot = new uPlot(this.options(this.axis), [[], ...lines.map(() => [])], this.box);
    this.box.strip = this.plot;  // for whoever asks the page for its data
    this.showLines();
    this.resize();
  }

  options(axis) {
    const shared = { font, stroke: () => colourOf('quiet'), grid: { stroke: () => colourOf('line'), width: 1 },
      ticks: { stroke: () => colourOf('line'), width: 1, size: 4 } };
    return {
      width: 300,
      height: 100,
      legend: { show: false },
      padding: [7, 18, axis ? 0 : 4, 0],
      cursor: { show: this.pointer, sync: { key: 'time' }, drag: { x: false, y: false }, points: { size: 6 } },
      focus: { alpha: 0.25 },
      scales: { x: { time: false, range: () => this.window }, y: { range: () => this.vertical } },
      axes: [
        { ...shared, space: 60, size: axis ? 22 : 0, ticks: { ...shared.ticks, show: axis },
          values: (plot, splits) => splits.map((at) => (axis ? clock(at) : '')) },
        { ...shared, size: 44, gap: 3, space: (plot, axis, low, high, height) => Math.min(26, Math.max(16, height / 4)), ...(this.ticks && { splits: () => this.ticks }),
          values: (plot, splits) => splits.map((at) => fixed(at, splits.some((other) => other % 1 !== 0) ? 1 : 0)) },
      ],
      series: [{}, ...this.lines.map(({ style }) => ({ stroke: () => colourOf(style.colour), width: style.width, dash: style.dash,
        spanGaps: false, points: { show: false } }))],
      hooks: { drawClear: [(plot) => drawHatching(plot, this.spans)], drawAxes: [(plot) => this.drawUnderLines(plot)],
        setCursor: [() => this.onCursor()] },
    };
  }

  drawUnderLines(plot) {
    this.drawZero(plot);
    if (this.highlighted !== null && isShown(this.highlighted)) drawSigmaBand(plot, this.rows, this.highlighted);
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
    const columns = this.lines.map(({ read }) => rows.map(read));
    this.vertical = this.limits(rows, columns.filter((column, i) => isShown(this.lines[i])));
    this.plot.setData([rows.map((row) => row.time), ...columns]);
  }

  /** Lines that were switched come or go, and the scale is that of those that are left. */
  showLines() {
    this.lines.forEach((line, i) => {
      if (this.plot.series[i + 1].show !== isShown(line)) this.plot.setSeries(i + 1, { show: isShown(line) });
    });
    this.draw(this.rows, this.spans, this.window);
  }

  /** One line before the others, with the sigma that is stated; null: none. */
  highlight(estimator) {
    const i = this.lines.findIndex((line) => line.estimator === estimator && isShown(line));
    this.highlighted = this.lines[i] ?? null;
    this.plot.setSeries(i < 0 ? null : i + 1, { focus: true });
    this.redraw();
  }

  redraw() {
    this.plot.redraw(false, true);
  }
}
