// SPDX-License-Identifier: MIT
// Makes page.cpp: the page around a report with its style, the bundled script and the licences of what is in it; and the
// script that draws a chart as a figure, for an engine that knows ES5 only.
// Usage: node build.mjs <folder of the sources> <page.cpp to write>   (in the folder of node_modules)
import { createHash } from 'node:crypto';
import { readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { build } from 'esbuild';
import typescript from 'typescript';

const [source, target] = process.argv.slice(2).map((path) => resolve(path));
const read = (name) => readFileSync(join(source, name), 'utf8');
const library = (name) => readFileSync(join('node_modules', name), 'utf8').trim();

async function bundle(options) {
  const { outputFiles } = await build({ bundle: true, minify: true, write: false, legalComments: 'none',
    charset: 'ascii', nodePaths: [resolve('node_modules')], absWorkingDir: source, logLevel: 'warning', ...options });
  return outputFiles[0].text.trim();
}

function licences() {
  const parts = [
    ['Apache ECharts', library('echarts/NOTICE'), library('echarts/LICENSE')],
    ['d3, parts in ECharts', library('echarts/licenses/LICENSE-d3')],
    ['zrender', library('zrender/LICENSE')],
    ['tslib', library('tslib/CopyrightNotice.txt'), library('tslib/LICENSE.txt')],
  ];
  return parts.map(([name, ...texts]) => `${name}\n${'='.repeat(name.length)}\n\n${texts.join('\n\n')}`).join('\n\n\n');
}

const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
const html = (text) => text.replace(/[&<>]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;' })[c]);

const script = await bundle({ entryPoints: ['page.js'], format: 'iife', target: 'es2020' });
const style = await bundle({ entryPoints: ['page.css'], target: ['chrome100', 'firefox100', 'safari15'] });
if (/<\/script|<!--/i.test(script)) throw new Error('the script would end its own element');

/** The colours of paper, which style sheets name first. */
const printColours = Object.fromEntries([read('page.css'), read('../../../line_colours.css')].flatMap((sheet) =>
  [...sheet.split('}')[0].matchAll(/--([a-z0-9-]+): (#[0-9a-f]+)/g)].map(([, name, colour]) => [name, colour])));
// Not the syntax: Duktape 2.7 takes no `in` within the head of a loop, where esbuild would put some.
const modern = await bundle({ entryPoints: ['figure.js'], format: 'iife', target: 'es2020', minify: false, minifyWhitespace: true,
  minifyIdentifiers: true, define: { PRINT_COLOURS: JSON.stringify(printColours) } });
const compiled = typescript.transpileModule(modern, { compilerOptions: { target: 'ES5', downlevelIteration: true } }).outputText;
const figureScript = (await build({ stdin: { contents: compiled }, minifyWhitespace: true, write: false, target: 'es5',
  charset: 'ascii', legalComments: 'none' })).outputFiles[0].text.trim();

// Nothing is loaded, only this script runs. Drawn charts set style attributes, so these are allowed.
const policy = [`default-src 'none'`, `script-src ${hash(script)}`, `style-src-elem ${hash(style)}`,
  `style-src-attr 'unsafe-inline'`, `base-uri 'none'`, `form-action 'none'`].join('; ');
const fill = { policy, style, script, licences: html(licences()) };
const page = read('page.html').replace(/\{\{(policy|style|script|licences)\}\}/g, (match, name) => fill[name]);
const parts = page.split(/\{\{(?:title|content|charts)\}\}/);
if (parts.length !== 4) throw new Error('page.html must name title, content and charts once each');

/** As C++ string literals of bounded length, in UTF-8 with all but plain ASCII escaped. */
function literal(text) {
  const escape = (byte) => (byte === 0x0a ? '\\n' : byte === 0x22 || byte === 0x5c || byte === 0x3f
    ? `\\${String.fromCharCode(byte)}` : byte >= 0x20 && byte < 0x7f ? String.fromCharCode(byte)
      : `\\${byte.toString(8).padStart(3, '0')}`);
  const bytes = [...Buffer.from(text, 'utf8')].map(escape);
  const lines = [];
  for (let i = 0; i < bytes.length; i += 120) lines.push(`    "${bytes.slice(i, i + 120).join('')}"`);
  return lines.join('\n');
}

writeFileSync(target, `// Made by charts/build.mjs.
#include "page.h"

namespace thermorig::report {

const bool has_charts = true;

const std::array<std::string_view, 4> page_parts{{
${parts.map(literal).join(',\n')}}};

const std::string_view figure_script{
${literal(figureScript)}};

}  // namespace thermorig::report
`);
