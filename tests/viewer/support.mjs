// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Tests named as claims, run one after the other; a folder to work in, and the command.
import { execFileSync } from 'node:child_process';
import { mkdirSync, rmSync, statSync } from 'node:fs';
import { join, resolve } from 'node:path';

const [command, packages, folder] = process.argv.slice(2).map((path) => resolve(path));
export { packages, folder };
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });

export function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}
if (statSync(join(packages, 'page.html')).size === 0) skip('this morula was built without its page');

/** Runs "morula ARGUMENTS" in the folder. */
export const morula = (line) => run(line.split(' '));
/** The same with arguments that have blanks. */
export const run = (args) => execFileSync(command, args, { cwd: folder, encoding: 'utf8' });
export const at = (name) => join(folder, name);

export function check(holds, what) {
  if (!holds) throw new Error(what);
}
export function equal(a, b, what) {
  check(a === b, `${what}: ${JSON.stringify(a)} is not ${JSON.stringify(b)}`);
}

let failed = 0;
export async function claim(name, test) {
  const begin = Date.now();
  try {
    await test();
    console.log(`ok      ${name} (${Date.now() - begin} ms)`);
  } catch (error) {
    ++failed;
    console.log(`FAILED  ${name}\n${error.stack}`);
  }
}
export function finish() {
  process.exitCode = failed > 0 ? 1 : 0;
}
