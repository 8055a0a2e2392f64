// SPDX-License-Identifier: MIT
import { plain } from './text.js';

const shortestWait = 500;  // ms between attempts, doubled up to
const longestWait = 5000;
const silentAfter = 4000;  // an open stream from which nothing comes is given up and opened again
const probeTime = 2000;    // ms for an answer
const refused = 1008;      // the server's close code for a wrong token

const tokenForm = /^[0-9a-f]{32}$/i;
const storageKey = 'thermorig token';

/** The token of the address's fragment, or the one that this tab had before; empty without. */
export function findToken() {
  const given = new URLSearchParams(location.hash.slice(1)).get('t') ?? '';
  try {
    if (tokenForm.test(given)) sessionStorage.setItem(storageKey, given);
    return given || (sessionStorage.getItem(storageKey) ?? '');
  } catch {
    return given;  // storage may be forbidden
  }
}

/** The stream of messages; it comes back by itself, for ever. */
export class Connection {
  /** `take(message)` for each object, `refuse()` when the token is not the program's. */
  constructor(take, refuse) {
    this.take = take;
    this.refuse = refuse;
    this.wait = shortestWait;
    this.token = findToken();
    this.heard = Date.now();
    this.quietUntil = 0;
    addEventListener('hashchange', () => {
      this.token = findToken();
      this.again(0);
    });
    addEventListener('online', () => this.again(0));
    setInterval(() => this.checkSilence(), 500);
    this.open();
  }

  get isOpen() {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  open() {
    clearTimeout(this.timer);
    this.timer = undefined;
    if (!tokenForm.test(this.token)) {
      this.refuse();
      return;
    }
    const socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/stream`);
    this.socket = socket;
    this.opened = Date.now();
    this.quietUntil = 0;
    socket.onopen = () => socket.send(JSON.stringify({ token: this.token }));
    socket.onmessage = ({ data }) => {
      if (socket === this.socket) this.receive(data);
    };
    socket.onclose = ({ code }) => {
      if (socket !== this.socket) return;
      if (code === refused) this.refuse();
      this.later();
    };
  }

  /** Tries again, after a wait that grows. */
  later() {
    this.again(this.wait);
    this.wait = Math.min(longestWait, this.wait * 2);
  }

  /** Tries again after `wait` ms. */
  again(wait) {
    const old = this.socket;
    this.socket = undefined;
    old?.close();
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.probe(), wait);
  }

  /** Asks for a small file before the stream: browsers delay streams to a host where many have failed by seconds. */
  async probe() {
    const timer = this.timer;
    let answers = false;
    try {
      answers = (await fetch('/icon.svg', { cache: 'no-store', signal: AbortSignal.timeout(probeTime) })).ok;
    } catch {
      // it does not
    }
    if (timer !== this.timer) return;
    if (answers) this.open();
    else this.later();
  }

  receive(data) {
    this.heard = Date.now();
    this.wait = shortestWait;
    let message;
    try {
      message = JSON.parse(data);
    } catch {
      return;
    }
    if (message !== null && typeof message === 'object') this.take(message);
  }

  /** The program has nothing to say for `ms`: silence is no reason to open the stream again. */
  expectSilence(ms) {
    this.quietUntil = Date.now() + ms;
  }

  /** A program that was frozen or a network that forgot us does not close the stream. */
  checkSilence() {
    const since = Math.max(this.heard, this.opened, this.quietUntil);
    if (this.socket === undefined || Date.now() - since < silentAfter) return;
    this.later();
  }

  /** Sends an order. Empty, or a sentence that says what went wrong. */
  async order(path, body) {
    try {
      const answer = await fetch(path, { method: 'POST', cache: 'no-store', body: JSON.stringify(body),
        headers: { 'Content-Type': 'application/json', Authorization: `Bearer ${this.token}` } });
      if (answer.ok) return '';
      let sentence = '';
      try {
        sentence = plain((await answer.json()).error);
      } catch {
        // no sentence came with it
      }
      return sentence || `the program answered ${answer.status}`;
    } catch {
      return 'the program does not answer';
    }
  }
}
