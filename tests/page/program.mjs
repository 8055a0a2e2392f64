// SPDX-License-Identifier: MIT
// The program itself, with its JSON lines.
import { spawn, spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { build, until } from './browser.mjs';

export const programPath = process.env.THERMORIG_PROGRAM ?? join(build, 'bin/thermorig');

/** Why the program cannot be tested here; empty if it can. */
export function whyNot() {
  if (!existsSync(programPath)) return `there is no ${programPath}: build the target thermorig`;
  const { status } = spawnSync(programPath, ['live', '--help'], { timeout: 20_000 });
  return status === 0 ? '' : `${programPath} has no command live`;
}

export class Program {
  /** `folder`: where it works and keeps its token. */
  constructor(folder, words) {
    this.messages = [];
    this.errors = '';
    this.child = spawn(programPath, ['live', '--json', ...words], { cwd: folder, env: { ...process.env, XDG_STATE_HOME: folder }, detached: true,
      stdio: ['ignore', 'pipe', 'pipe'] });
    this.ended = new Promise((done) => this.child.on('close', (code, signal) => done(code ?? signal)));
    createInterface({ input: this.child.stdout }).on('line', (line) => this.messages.push(JSON.parse(line)));
    this.child.stderr.on('data', (part) => { this.errors += part; });
  }

  of(event) {
    return this.messages.filter((message) => message.event === event);
  }

  /** The URL of its page, as it is printed. */
  async url() {
    const find = () => /http:\/\/127\.0\.0\.1:\d+\/#t=[0-9a-f]{32}/.exec(this.errors + JSON.stringify(this.messages.slice(0, 20)));
    await until(find, `the program prints its URL; it said: ${this.errors}`, 30_000);
    return find()[0];
  }

  kill() {
    try {
      process.kill(-this.child.pid, 'SIGKILL');
    } catch {
      // it is gone
    }
    return this.ended;
  }
}
