import { existsSync } from 'node:fs';
import { chromium, type Browser } from 'playwright-core';

const kBrowser =
  process.env.AERATE_BROWSER ?? ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);

// Chromium draws on the CPU.
const kArguments = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

export function launch(): Promise<Browser> {
  if (!kBrowser) throw new Error('there is no Chromium: AERATE_BROWSER says where one is');
  return chromium.launch({ executablePath: kBrowser, args: kArguments });
}
