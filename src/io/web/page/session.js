// SPDX-License-Identifier: MIT
// The page of a finished session: docs/session_page.md says what comes, and from where.
import { Keys } from './keys.js';
import { LinesTable, linesOf } from './session_lines.js';
import { moment, SessionFacts, timeOfDay } from './session_facts.js';
import { SessionPlots } from './session_plots.js';
import { Rows } from './session_rows.js';
import { findSource } from './session_source.js';
import { sharedActions } from './shared_actions.js';
import { ThermalImage } from './thermal_image.js';
import { byId, clock, count, fixed, plain, say } from './text.js';
import { Warnings } from './warnings.js';

const freshWords = ['repeated', 'half', 'both'];
const stepSeconds = 1;  // of a key with Shift

const source = findSource();
const warnings = new Warnings();
const image = new ThermalImage();

/** One cursor over everything that the session says. */
class Session {
  constructor(facts, rows) {
    this.given = facts;
    this.rows = rows;
    const { lines, left } = linesOf(facts, rows);
    this.facts = new SessionFacts(facts, (begin, end) => this.showPart(begin, end));
    this.plots = new SessionPlots(rows, lines, (row) => this.seek(row));
    this.table = new LinesTable(lines, () => this.plots.showLines(), (line) => this.plots.highlight(line));
    [this.valid, this.fresh, this.reasons, this.leg, this.run, this.missing] = ['valid', 'fresh', 'reasons', 'leg', 'run', 'missing'].map((name) => rows.get(name));
    this.angle = rows.get('angle_deg');
    this.row = 0;
    this.loading = false;
    this.playing = null;
    const slider = byId('seek');
    slider.max = rows.count - 1;
    slider.addEventListener('input', () => this.seek(slider.valueAsNumber));
    say(byId('frame-of'), `of 0 to ${count(rows.frameOf(rows.count - 1))}`);
    say(byId('estimates-note'), lines.length > 4 ? (left > 0 ? `${count(left)} more estimators than this page shows.` : '')
      : 'No estimates in this session: it is not of a live run.');
    this.seek(this.valid.indexOf(1));  // or the first, where none is valid
  }

  /** Goes to a row. */
  seek(row) {
    this.row = Math.min(this.rows.count - 1, Math.max(0, Math.round(row)));
    if (this.playing !== null && this.row !== this.playing.row) this.stop();
    this.plots.seek(this.row);
    byId('seek').value = this.row;
    this.showFrame();
    this.showImage();
  }

  step(rows) {
    this.seek(this.row + rows);
  }

  stepSeconds(seconds) {
    this.seek(this.rows.nearest(this.rows.time[this.row] + seconds));
  }

  showPart(begin, end) {
    const margin = Math.max(2, (end - begin) / 4);
    this.plots.show(begin - margin, end + margin);
    this.seek(this.rows.nearest(begin));
  }

  showFrame() {
    const { row, rows } = this;
    const time = rows.time[row];
    const frame = rows.frameOf(row);
    const valid = this.valid[row] === 1;
    const reasons = this.facts.reasonNames(this.reasons[row]);
    say(byId('frame-number'), count(frame));
    byId('frame').dataset.frame = frame;
    say(byId('frame-time'), [moment(time), `${fixed(time, 3)} s`, timeOfDay(this.given.start_utc, time)].filter((text) => text !== '').join(' · '));
    say(byId('frame-leg'), [this.facts.legText(this.leg[row]), this.run[row] > 0 ? `run ${this.run[row]}` : '', `angle ${fixed(this.angle[row], 1)}°`,
      this.missing[row] > 0 ? `${count(this.missing[row])} missing before` : ''].filter((text) => text !== '').join(' · '));
    byId('validity').dataset.valid = valid;
    say(byId('validity'), valid ? '✓ valid' : '▲ not valid');
    say(byId('reasons'), reasons.join(', '));
    byId('seek').setAttribute('aria-valuetext', `frame ${frame}, ${moment(time)}, ${valid ? 'valid' : 'not valid'}`);
    image.freshness(freshWords[this.fresh[row]]);
    this.table.show(row);
  }

  /** One image is asked for at a time; then that of the frame that is looked at by then. */
  async showImage() {
    if (this.loading) return;
    this.loading = true;
    try {
      for (let shown = -1; shown !== this.row;) {
        shown = this.row;
        await this.loadImage(shown);
      }
    } finally {
      this.loading = false;
    }
  }

  async loadImage(row) {
    const frame = this.rows.frameOf(row);
    try {
      const { frame: of, temperatures, precision } = await source.image(frame);
      if (!image.range.locked) image.range.clear();
      image.show(temperatures, null);
      image.freshness(freshWords[this.fresh[row]]);
      image.draw();
      byId('thermal').dataset.frame = of;
      this.showNote(of === frame ? '' : `The image shows frame ${count(of)}.`, precision);
      warnings.set('image', '');
      source.prepare(Math.min(this.rows.frameOf(this.rows.count - 1), frame + 64));
    } catch (error) {
      image.showNone();
      delete byId('thermal').dataset.frame;
      warnings.set('image', plain(error.message, 300));
    }
  }

  showNote(note, precision) {
    const exact = precision === null || !(precision > 0.005) ? '' : `Temperatures within ±${fixed(precision, 2)} °C of the session's.`;
    const text = [note, exact].filter((part) => part !== '').join(' ');
    byId('image-note').hidden = text === '';
    say(byId('image-note'), text);
  }

  /** Plays from here as it was, or stops. */
  play() {
    if (this.playing !== null) {
      this.stop();
      return;
    }
    if (this.row === this.rows.count - 1) this.seek(0);
    this.playing = { row: this.row, from: this.rows.time[this.row], since: performance.now() };
    this.pressPlay(true);
    requestAnimationFrame(() => this.playOn());
  }

  playOn() {
    if (this.playing === null) return;
    const time = this.playing.from + (performance.now() - this.playing.since) / 1000;
    const row = Math.max(0, this.rows.firstFrom(time) - 1);
    if (row > this.row) {
      this.playing.row = Math.min(this.rows.count - 1, row);
      this.seek(this.playing.row);
    }
    if (this.row === this.rows.count - 1) this.stop();
    else requestAnimationFrame(() => this.playOn());
  }

  stop() {
    this.playing = null;
    this.pressPlay(false);
  }

  pressPlay(on) {
    byId('play').setAttribute('aria-pressed', String(on));
    say(byId('play').lastElementChild, on ? 'pause' : 'play');
  }

  /** "1200" is a frame, "1:23.4" or "83.4s" a time. Whether it was understood. */
  goTo(text) {
    const known = text.trim();
    if (/^\d{1,9}$/.test(known)) {
      this.seek(this.rows.rowOf(Number(known)));
      return true;
    }
    const parts = /^(?:(?:(\d{1,4}):)?(\d{1,6}):)?(\d{1,7}(?:\.\d{1,6})?) ?(s)?$/.exec(known);
    if (parts === null || (parts[2] === undefined && parts[4] === undefined && !known.includes('.'))) return false;
    this.seek(this.rows.nearest(3600 * Number(parts[1] ?? 0) + 60 * Number(parts[2] ?? 0) + Number(parts[3])));
    return true;
  }
}

function actionsOf(session) {
  const { rows, plots } = session;
  const zoomIn = () => plots.zoomIn();
  return {
    arrowleft: (event) => (event.shiftKey ? session.stepSeconds(-stepSeconds) : session.step(-1)),
    arrowright: (event) => (event.shiftKey ? session.stepSeconds(stepSeconds) : session.step(1)),
    home: () => session.seek(0),
    end: () => session.seek(rows.count - 1),
    '+': zoomIn,
    '=': zoomIn,
    '-': () => plots.zoomOut(),
    0: () => plots.showAll(),
    n: () => session.seek(rows.nextChange(session.row, 1)),
    p: () => session.seek(rows.nextChange(session.row, -1)),
    g: () => byId('goto').select(),
    ...sharedActions(image),
  };
}

function listenToField(session) {
  const field = byId('goto');
  field.addEventListener('keydown', (event) => {
    if (event.key === 'Escape') field.blur();
    if (event.key !== 'Enter') return;
    const understood = session.goTo(field.value);
    say(byId('goto-trouble'), understood ? '' : 'a frame (1200) or a time (1:23.4, 83.4s)');
    if (understood) field.blur();
  });
}

async function open() {
  try {
    const facts = await source.facts();
    const rows = new Rows(facts, await source.rows());
    if (rows.count === 0) {
      new SessionFacts(facts, () => {});
      warnings.set('rows', 'This session has no frames.');
      return;
    }
    const session = new Session(facts, rows);
    new Keys(actionsOf(session), () => session.play(), { button: 'play', field: 'goto', repeated: ['arrowleft', 'arrowright', '+', '=', '-'] });
    listenToField(session);
    warnings.set('left out', plain(source.leftOut(), 500));
    document.documentElement.dataset.opened = `${clock(rows.end)}`;
  } catch (error) {
    say(byId('mode-word'), 'NOT OPENED');
    byId('mode').dataset.mode = 'refused';
    warnings.set('open', `This session cannot be shown: ${plain(error.message, 300)}`);
  }
}

open();
