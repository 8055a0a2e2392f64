// SPDX-License-Identifier: MIT
import { byId, bytes, clock, count, fields, number, plain, say } from './text.js';

const words = { connecting: 'CONNECTING', refused: 'NOT CONNECTED', recording: 'RECORDING', live: 'LIVE', replay: 'REPLAY', ended: 'ENDED', silent: 'NO DATA' };
const marks = { connecting: '○', refused: '▲', silent: '▲', recording: '●', live: '▶', replay: '»', ended: '■' };

/** The state of the run in words, shape and colour; the title of the tab repeats it. */
export class Band {
  constructor() {
    this.mode = 'connecting';
    this.environment = '';
    this.silent = false;
    this.planned = null;
    this.last = {};  // newest state
    this.show();
  }

  hello(message) {
    this.last = {};
    this.mode = message.mode === 'replay' ? 'replay' : message.recording === true ? 'recording' : 'live';
    this.environment = plain(message.environment, 60);
    this.repeats = fields(message.plan).repeats === true;
    this.planned = this.repeats ? null : number(fields(message.plan).expected_s);
    const simulated = byId('simulated');
    simulated.hidden = message.simulated !== true;
    simulated.title = plain(message.simulation, 300);
    const acquisition = number(message.acquisition);
    say(byId('environment'), this.environment);
    say(byId('acquisition'), acquisition === null ? '' : `acquisition ${count(acquisition)}`);
    say(byId('stop'), this.mode === 'replay' ? 'Stop replay (Space)' : 'Stop servo (Space)');
    this.control = message.control === true;
    byId('start').hidden = !this.control;
    say(byId('announcement'), `${words[this.mode]}${message.simulated === true ? ', simulated' : ''}`);
    this.show();
  }

  state(message) {
    this.last = message;
    byId('start').disabled = message.phase !== 'waiting';  // it moves, or has
    const kept = number(message.kept_frames);
    say(byId('kept'), kept === null ? (this.mode === 'replay' ? '' : 'not saved') : `${count(kept)} frames saved`);
    byId('kept').title = number(message.kept_bytes) === null ? '' : bytes(message.kept_bytes);
    const free = number(message.disk_free_bytes);
    say(byId('disk'), free === null ? '' : `${bytes(free)} free`);
    this.show();
  }

  /** Nothing has been driven yet, and the time to go stands still. */
  get waits() {
    return this.last.phase === 'waiting' && this.last.stopping !== true;
  }

  /** What the program does now; nothing where nobody knows, or it does nothing any more. */
  phaseText() {
    if (this.shown === 'silent' || this.mode === 'ended') return '';
    const { phase, stopping } = this.last;
    if (this.waits) return this.control ? 'waits for Start sweep' : 'checks the devices';
    if (phase === 'done') return number(this.last.kept_frames) === null ? 'done' : 'closing the file …';
    return stopping === true ? '▲ stopping' : plain(phase, 40).replaceAll('_', ' ');
  }

  /** Time of the run: it counts down while the program tells it, and never by itself. */
  elapsedText() {
    const now = number(this.last.time_s);
    if (now === null) return '';
    if (this.mode === 'ended') return clock(now);
    if (this.shown === 'silent') return `last data at ${clock(now)}`;
    const left = number(this.last.eta_s);
    if (this.waits && this.control) {
      const whole = left ?? this.planned;
      return whole === null ? clock(now) : `${clock(now)}, the sweep takes ${clock(whole)}`;
    }
    const planned = left === null ? this.planned : now + left;
    return `${clock(now)}${planned === null ? '' : ` of ${clock(planned)}`}${
      left !== null ? `, ${clock(left)} to go` : this.repeats ? ', until it is stopped' : ''}`;
  }

  ended() {
    this.mode = 'ended';
    byId('start').hidden = true;
    this.show();
  }

  /** The program does not take this page's token. */
  refused() {
    this.mode = 'refused';
    this.last = {};
    for (const id of ['environment', 'acquisition', 'kept', 'disk']) say(byId(id), '');
    byId('start').hidden = true;
    this.show();
  }

  /** A run of which nothing comes any more is none that is known to go on, whatever it was. */
  get shown() {
    return this.silent && ['recording', 'live', 'replay'].includes(this.mode) ? 'silent' : this.mode;
  }

  silence(silent) {
    if (this.silent === silent) return;
    this.silent = silent;
    this.show();
  }

  show() {
    byId('mode').dataset.mode = this.shown;
    say(byId('mode-word'), words[this.shown]);
    say(byId('phase'), this.phaseText());
    say(byId('elapsed'), this.elapsedText());
    const title = `${marks[this.shown]} ${words[this.shown]}${this.environment === '' ? '' : ` ${this.environment}`} · thermorig`;
    if (document.title !== title) document.title = title;
  }
}
