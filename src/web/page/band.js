// SPDX-License-Identifier: MIT
import { byId, bytes, clock, count, fields, number, plain, say } from './text.js';

const words = { connecting: 'CONNECTING', refused: 'NOT CONNECTED', recording: 'RECORDING', live: 'LIVE', replay: 'REPLAY', ended: 'ENDED' };
const marks = { connecting: '○', refused: '▲', recording: '●', live: '▶', replay: '»', ended: '■' };

/** The state of the run in words, shape and colour; the title of the tab repeats it. */
export class Band {
  constructor() {
    this.mode = 'connecting';
    this.environment = '';
    this.silent = false;
    this.planned = null;
    this.show();
  }

  hello(message) {
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
    byId('start').hidden = message.control !== true;
    say(byId('announcement'), `${words[this.mode]}${message.simulated === true ? ', simulated' : ''}`);
    this.show();
  }

  state(message) {
    const now = number(message.time_s);
    this.elapsed = now;
    const left = number(message.eta_s);
    const planned = left !== null && now !== null ? now + left : this.planned;
    say(byId('elapsed'), now === null ? '' : `${clock(now)}${planned === null ? '' : ` of ${clock(planned)}`}${
      left !== null ? `, ${clock(left)} to go` : this.repeats ? ', until it is stopped' : ''}`);
    byId('start').disabled = message.phase !== 'waiting';  // it moves, or has
    const kept = number(message.kept_frames);
    say(byId('phase'), this.phaseText(message, kept !== null));
    say(byId('kept'), kept === null ? (this.mode === 'replay' ? '' : 'nothing is kept') : `${count(kept)} frames kept`);
    byId('kept').title = number(message.kept_bytes) === null ? '' : bytes(message.kept_bytes);
    const free = number(message.disk_free_bytes);
    say(byId('disk'), free === null ? '' : `${bytes(free)} free`);
  }

  phaseText(message, keeps) {
    if (message.phase === 'done' && this.mode !== 'ended') return keeps ? 'closing the file …' : 'done';
    return message.stopping === true ? '▲ stopping' : plain(message.phase, 40).replaceAll('_', ' ');
  }

  ended() {
    this.mode = 'ended';
    say(byId('phase'), '');
    say(byId('elapsed'), number(this.elapsed) === null ? '' : clock(this.elapsed));
    byId('start').hidden = true;
    this.show();
  }

  /** The program does not take this page's token. */
  refused() {
    this.mode = 'refused';
    for (const id of ['environment', 'acquisition', 'phase', 'elapsed', 'kept', 'disk']) say(byId(id), '');
    byId('start').hidden = true;
    this.show();
  }

  silence(silent) {
    if (this.silent === silent) return;
    this.silent = silent;
    this.show();
  }

  show() {
    byId('mode').dataset.mode = this.mode;
    say(byId('mode-word'), words[this.mode]);
    const title = `${marks[this.mode]} ${words[this.mode]}${this.environment === '' ? '' : ` ${this.environment}`} · thermorig`;
    document.title = this.silent ? `▲ NO DATA · ${title}` : title;
  }
}
