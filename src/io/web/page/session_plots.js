// SPDX-License-Identifier: MIT
import { excludedSpans } from './hatching.js';
import { countedFirst, everything } from './limits.js';
import { validShares, thinned } from './thinned.js';
import { Strip } from './strip.js';
import { byId, clock, fixed, say } from './text.js';
import { colourOf, onThemeChange } from './theme.js';

const zoomStep = 1.6;
const leastFrames = 8;  // that a plot shows

/** Rate and difference over one window of time, with one cursor, over a picture of the whole session. */
export class SessionPlots {
  /** `lines`: each with `rate` and `difference`, columns of the rows, or null; `onSeek(row)` when a frame was pointed at. */
  constructor(rows, lines, onSeek) {
    this.rows = rows;
    this.lines = lines;
    this.onSeek = onSeek;
    this.row = 0;
    this.window = [rows.begin, rows.end];
    this.waiting = false;
    this.strips = [['rate', everything(5)], ['error', countedFirst(1)]].map(([id, limits]) => new Strip(id, { limits, axis: true, pointer: false }));
    this.columns = ['rate', 'difference'].map((of) => lines.map((line) => line[of]).filter((column) => column !== null));
    this.strips.forEach((strip, i) => strip.setLines(this.linesOf(['rate', 'difference'][i])));
    this.cursors = this.strips.map((strip) => this.addCursor(strip));
    for (const strip of this.strips) this.listen(strip.box, (x) => strip.plot.posToVal(x - strip.plot.over.getBoundingClientRect().left, 'x'));
    this.overview = byId('overview');
    this.listen(this.overview, (x) => {
      const box = this.overview.getBoundingClientRect();
      return rows.begin + ((x - box.left) / Math.max(1, box.width)) * (rows.end - rows.begin);
    });
    new ResizeObserver(() => this.drawSoon()).observe(byId('whole'));
    for (const strip of this.strips) new ResizeObserver(() => this.drawSoon()).observe(strip.box);
    onThemeChange(() => this.drawSoon());
    this.drawSoon();
  }

  linesOf(which) {
    return this.lines.filter((line) => line[which] !== null).map((line, i) => ({ estimator: line, style: line.line, read: (row) => row.values[i], sigma: () => null }));
  }

  addCursor(strip) {
    const line = document.createElement('i');
    line.className = 'time-cursor';
    strip.plot.over.append(line);
    return line;
  }

  /** Pressing and drawing goes to a time, the wheel zooms there. */
  listen(box, timeAt) {
    const seek = (event) => this.onSeek(this.rows.nearest(timeAt(event.clientX)));
    box.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      box.setPointerCapture(event.pointerId);
      seek(event);
    });
    box.addEventListener('pointermove', (event) => {
      if (box.hasPointerCapture(event.pointerId)) seek(event);
    });
    box.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.zoom(zoomStep ** Math.sign(event.deltaY), box === this.overview ? undefined : timeAt(event.clientX));
    }, { passive: false });
  }

  /** Steps of a key or a button. */
  zoomIn() {
    this.zoom(1 / zoomStep);
  }

  zoomOut() {
    this.zoom(zoomStep);
  }

  /** `factor` above 1 shows more; `at` stays where it is. */
  zoom(factor, at = this.rows.time[this.row]) {
    const { begin, end, period } = this.rows;
    const old = this.window[1] - this.window[0];
    const span = Math.min(end - begin, Math.max(leastFrames * period, old * factor));
    const share = Math.min(1, Math.max(0, (at - this.window[0]) / old));
    this.show(at - share * span, at + (1 - share) * span);
  }

  /** A window of that length, within the session. */
  show(from, to) {
    const { begin, end, period } = this.rows;
    const span = Math.min(end - begin, Math.max(Math.min(leastFrames * period, end - begin), to - from));
    const first = Math.min(end - span, Math.max(begin, from));
    this.window = [first, first + span];
    this.drawSoon();
  }

  showAll() {
    this.show(this.rows.begin, this.rows.end);
  }

  /** The cursor's row; the window goes along where it would leave it. */
  seek(row) {
    this.row = row;
    const time = this.rows.time[row];
    const span = this.window[1] - this.window[0];
    if (time < this.window[0] || time > this.window[1]) this.show(time - span / 2, time + span / 2);
    this.drawCursor();
  }

  drawSoon() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  draw() {
    this.strips.forEach((strip, i) => {
      const shown = thinned(this.rows, this.columns[i], this.window, strip.box.clientWidth);
      strip.draw(shown, excludedSpans(shown), this.window);
    });
    const span = this.window[1] - this.window[0];
    say(byId('window'), span < 60 ? `${fixed(span, 1)} s` : clock(span));
    this.drawOverview();
    this.drawCursor();
  }

  drawCursor() {
    this.strips.forEach((strip, i) => {
      const x = strip.plot.valToPos(this.rows.time[this.row], 'x');
      this.cursors[i].style.transform = `translateX(${Math.round(x)}px)`;
    });
    this.drawOverview();
  }

  /** Bars as high as the share of valid frames, the window as a box, the cursor as a line. */
  drawOverview() {
    const { overview: canvas, rows } = this;
    const { clientWidth: width, clientHeight: height } = canvas;
    if (width === 0 || height === 0) return;
    const sharp = devicePixelRatio;
    if (canvas.width !== Math.round(width * sharp) || canvas.height !== Math.round(height * sharp)) {
      canvas.width = Math.round(width * sharp);
      canvas.height = Math.round(height * sharp);
      this.shares = validShares(rows, width);
    }
    const context = canvas.getContext('2d');
    context.setTransform(sharp, 0, 0, sharp, 0, 0);
    context.clearRect(0, 0, width, height);
    context.fillStyle = colourOf('fresh');
    this.shares.forEach((share, x) => context.fillRect(x, (height - 1) * (1 - (share ?? 0)), 1, (height - 1) * (share ?? 0)));
    context.fillStyle = colourOf('line');
    context.fillRect(0, height - 1, width, 1);
    const at = (time) => ((time - rows.begin) / (rows.end - rows.begin)) * width;
    const [left, right] = this.window.map(at);
    context.fillStyle = colourOf('veil');
    if (left > 0) context.fillRect(0, 0, left, height);
    if (right < width) context.fillRect(right, 0, width - right, height);
    context.strokeStyle = colourOf('ink');
    context.strokeRect(left + 0.5, 0.5, Math.max(2, right - left - 1), height - 1);
    context.fillStyle = colourOf('bad');
    context.fillRect(Math.min(width - 2, Math.max(0, at(rows.time[this.row]) - 1)), 0, 2, height);
  }

  /** Lines that were switched off or on. */
  showLines() {
    for (const strip of this.strips) strip.showLines();
  }

  /** One line before the others; null: none. */
  highlight(line) {
    for (const strip of this.strips) strip.highlight(line);
  }
}
