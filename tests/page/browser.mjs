// SPDX-License-Identifier: MIT
// What the browser tests share: a browser, a page on a server, ways to read what is on it.
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

export const build = process.env.THERMORIG_BUILD;
export const filesFolder = join(build, 'src/io/web/page/files');
const output = process.env.THERMORIG_PAGE_OUTPUT;
mkdirSync(output, { recursive: true });

export function launch() {
  return chromium.launch({ executablePath: process.env.THERMORIG_CHROMIUM, args: ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic',
    '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'] });
}

const spare = new Map();  // tabs that were closed, by what they are like: a new one takes longer than most tests

/**
 * A tab; `troubles` collects whatever the browser complains of: errors of scripts and refusals of the policy. `close` leaves it empty, for
 * another test, but where its clock stands still.
 */
export async function openTab(browser, { width = 1280, height = 800, dark = false, calm = false, clock = false } = {}) {
  const kind = JSON.stringify({ width, height, dark, calm });
  const waiting = spare.get(kind) ?? [];
  spare.set(kind, waiting);
  if (!clock && waiting.length > 0) return waiting.pop();
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: dark ? 'dark' : 'light',
    reducedMotion: calm ? 'reduce' : 'no-preference', locale: 'en-GB' });
  const tab = await context.newPage();
  const troubles = [];
  tab.on('pageerror', (error) => troubles.push(String(error)));
  tab.on('console', (message) => {
    if (message.type() === 'error' && !/WebSocket connection|ERR_CONNECTION|Failed to load resource/.test(message.text())) troubles.push(message.text());
  });
  tab.underWay = new Set();  // requests without an answer: they take real time
  tab.on('request', (request) => tab.underWay.add(request));
  tab.on('response', (response) => tab.underWay.delete(response.request()));
  tab.on('requestfailed', (request) => tab.underWay.delete(request));
  if (clock) await tab.clock.install();
  const opened = { tab, troubles };
  opened.close = async () => {
    if (clock) return context.close();
    await tab.mouse.move(0, 0);
    await tab.evaluate(() => sessionStorage.clear());
    await tab.goto('about:blank');
    troubles.length = 0;
    tab.underWay.clear();
    waiting.push(opened);
  };
  return opened;
}

export const screenshot = (tab, name) => tab.screenshot({ path: join(output, `${name}.png`) });

/** The data of a plot: its times, then a column a line. */
export const stripData = (tab, id) => tab.evaluate((name) => document.querySelector(`#${name} .plot`).strip.data, id);

export const imagePixels = (tab) => tab.evaluate(() => {
  const canvas = document.getElementById('image');
  return [...canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data];
});

export const textOf = (tab, selector) => tab.locator(selector).textContent();

/** Waits on the test's own clock, for pages whose clock stands still. */
export async function until(condition, what, milliseconds = 8000) {
  const end = performance.now() + milliseconds;
  while (performance.now() < end) {
    if (await condition()) return;
    await new Promise((done) => setTimeout(done, 20));
  }
  throw new Error(`not within ${milliseconds} ms: ${what}`);
}

/** Runs the clock of a page, which stands still, until it happens, and so long at most. What has begun may end in real time. */
export async function untilOnItsClock(tab, condition, what, milliseconds) {
  for (let passed = 0; passed < milliseconds && !(await condition()); passed += 200) {
    await tab.clock.runFor(200);
    await new Promise((done) => setTimeout(done, 20));
    await until(() => tab.underWay.size === 0, `answers, for ${what}`);
  }
  await until(condition, `${what}, within ${milliseconds} ms of the page's clock`);
}
