// The studio, by the built program: what somebody does who drops a model and takes the result away.
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Browser, BrowserContextOptions, Download, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, it } from 'vitest';
import { raised } from '../src/figures';
import type { Report } from '../src/studio/told';
import { sentence } from '../src/studio/words';
import { launch } from './browser';
import { pixelsOf } from './pixels';
import { Program, saidOf } from './program';
import { unreadable } from './readable';

const kBunny = new URL('../../samples/bunny.stl', import.meta.url).pathname;
const kView: BrowserContextOptions = { viewport: { width: 1100, height: 720 }, colorScheme: 'light' };
// Where pixels are not looked at, since Chromium draws on the CPU.
const kCoarse: BrowserContextOptions = { deviceScaleFactor: 0.5 };

let browser: Browser;
let program: Program;
let folder = '';
let messages: string[] = [];

beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), 'aerate-e2e-'));
  [browser, program] = await Promise.all([launch(), Program.start('--max-upload', '2M')]);
});
afterAll(async () => {
  await browser?.close();
  await program?.end();
  rmSync(folder, { recursive: true });
});
beforeEach(() => (messages = []));
afterEach(() => expect(messages).toEqual([]));

// What the browser itself says of an answer that is a refusal; nothing else is allowed.
function allowRefusals(status: string): void {
  messages = messages.filter((message) => !(message.startsWith('Failed to load resource') && message.includes(status)));
}

async function open(options: BrowserContextOptions = kCoarse, address = program.address): Promise<Page> {
  const context = await browser.newContext({ ...kView, ...options });
  return openIn(await context.newPage(), address);
}

async function openIn(page: Page, address = program.address): Promise<Page> {
  page.on('console', (message) => messages.push(message.text()));
  page.on('pageerror', (error) => messages.push(error.message));
  await page.goto(address);
  await page.waitForSelector('html[data-connection=open]');
  return page;
}

const kShown = (what: 'models' | 'jobs'): string => `#view .slot[data-ready^=${what}]`;

// As a hand does it: over the page, and let go.
async function drop(page: Page, file: string): Promise<void> {
  const bytes = readFileSync(file).toString('base64');
  const data = await page.evaluateHandle(
    async ([base64, name]) => {
      const transfer = new DataTransfer();
      transfer.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
      return transfer;
    },
    [bytes, file.split('/').at(-1)!] as const,
  );
  for (const type of ['dragenter', 'dragover', 'drop']) await page.dispatchEvent('main', type, { dataTransfer: data });
}

async function send(page: Page, file = kBunny): Promise<void> {
  await page.setInputFiles('#chooser', file);
  await page.waitForSelector(kShown('models'));
}

// Of a shape that is quick.
async function hollow(page: Page): Promise<void> {
  await page.check('input[name=choice-shape][value=spheres]');
  await page.fill('#option-min-radius', '3');
  await page.click('#go');
}

// Results are asked about first.
async function remove(page: Page, name: string): Promise<void> {
  await page.click(`[aria-label="Remove ${name}"]`);
  const question = page.locator('dialog');
  if (await question.isVisible()) await question.locator('button:has-text("Remove")').click();
  await page.waitForFunction((label) => !document.querySelector(`[aria-label="${label}"]`), `Remove ${name}`);
}

async function openGroups(page: Page): Promise<void> {
  await page.evaluate(() => document.querySelectorAll('details.group').forEach((group) => group.setAttribute('open', '')));
}

async function take(page: Page, button: string): Promise<{ readonly name: string; readonly bytes: Buffer }> {
  const [download]: [Download, void] = await Promise.all([page.waitForEvent('download'), page.click(button)]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}

describe('a model', () => {
  let page: Page;
  beforeAll(async () => (page = await open({ acceptDownloads: true })));
  afterAll(() => page.context().close());

  it('is dropped, estimated and hollowed, and its figures are those of the report', async () => {
    await drop(page, kBunny);
    await page.waitForSelector(kShown('models'));
    expect(await page.textContent('#model-list')).toContain('7,202 triangles');
    await openGroups(page);
    await page.waitForFunction(() => document.querySelectorAll('#estimate dd').length > 0);
    const before = await page.textContent('#command');
    await page.fill('#option-wall', '2');
    await page.waitForFunction((old) => document.getElementById('command')?.textContent !== old, before);
    expect(await page.textContent('#command')).toMatch(/^aerate hollow bunny\.stl .*--wall[= ]2/);
    await hollow(page);
    await page.waitForSelector(kShown('jobs'));

    const report = JSON.parse((await take(page, 'text=Report, JSON')).bytes.toString()) as Report;
    const figures = (await page.textContent('#shown-figures')) ?? '';
    const cm3 = (mm3: number) => (mm3 / 1000).toLocaleString('en', { minimumFractionDigits: 1, maximumFractionDigits: 1 });
    expect(report.measured.wall_mm).toBeGreaterThanOrEqual(2);
    expect(figures).toContain(raised(`${cm3(report.volume.before_mm3)} cm3`));
    expect(figures).toContain(raised(`${cm3(report.volume.after_mm3!)} cm3`));
    expect(figures).toContain(`${report.material!.mass_after_g.toFixed(1)} g`);
    expect(figures).toContain(`${report.voids.count}, radius`);
    const stl = await take(page, '.file[data-form=stl]');
    expect(stl.name).toMatch(/^bunny.*\.stl$/);
    expect(stl.bytes.readUInt32LE(80)).toBe(report.output.triangles);
    const zipped = await take(page, '.file[data-form="3mf"]');
    expect(zipped.bytes.subarray(0, 2).toString()).toBe('PK');
    expect((await take(page, 'text=Report')).bytes.toString()).toContain('bunny');
  });

  it('is cut: background in a void, hatched solid beside it', async () => {
    await page.check('#shown-panel input[name=axis][value=y]');
    const { share, ...places } = await page.evaluate(() => {
      const { scene, project, size, centre } = window.aerateStudio!['shown-']!;
      const largest = scene.voids.radius.indexOf(Math.max(...scene.voids.radius));
      const [x, y, z] = [0, 1, 2].map((k) => scene.voids.place[3 * largest + k]);
      return {
        share: (y - centre[1]) / size[1] + 0.5,
        middle: project([x, y, z]),
        beside: project([x + scene.voids.radius[largest] + 0.45, y, z]),
      };
    });
    await page.fill('#shown-cut', String(Math.round(500 * share)));
    await page.check('#shown-alone');
    const face = await pixelsOf(page, 'shown-canvas');
    expect(await face.opacity(places.middle)).toBe(0);
    expect(await face.opacity(places.beside)).toBe(255);
    expect(await face.coloursRound(places.beside)).toBeGreaterThan(1);
    await page.fill('#shown-cut', '0');
    expect(await (await pixelsOf(page, 'shown-canvas')).opacity(places.beside)).toBe(0);
  });

  it('is there again when the page is loaded again, with what was given', async () => {
    await page.reload();
    await page.waitForSelector(kShown('jobs'));
    expect(await page.inputValue('#option-wall')).toBe('2');
    expect(page.url()).not.toContain('#');
    expect(await page.evaluate(() => window.localStorage.length)).toBe(0);
  });

  it('is compared: the solid, voids and modifiers in one table, two beside each other that turn together', async () => {
    await page.click('#tab-comparison');
    await page.click('text=Make modifiers, to compare');
    await page.waitForSelector('.comparison thead th:nth-child(4)');
    expect(await page.locator('.comparison thead th').allTextContents()).toEqual(['Solid', expect.stringMatching(/^Voids/), expect.stringMatching(/^Modifiers/)]);
    expect(await page.textContent('.comparison tbody')).toMatch(/Filament at 15 % infill/);
    await page.waitForFunction(() => document.querySelectorAll('.side .slot[data-ready^=jobs]').length === 2);
    const before = await pixelsOf(page, 'right-canvas');
    await page.focus('#left-canvas');
    await page.keyboard.press('ArrowLeft');
    expect((await pixelsOf(page, 'right-canvas')).differs(before)).toBe(true);
    await page.check('#right-panel input[name=axis][value=z]');
    expect(await page.isChecked('#left-panel input[name=axis][value=z]')).toBe(true);
  });

  it('is removed with all that was made of it, if that is wanted', async () => {
    await page.click('[aria-label="Remove bunny.stl"]');
    expect(await page.textContent('dialog')).toContain('the 2 results made of it');
    await page.keyboard.press('Escape');
    await page.waitForSelector('dialog', { state: 'detached' });
    await page.click('[aria-label="Remove bunny.stl"]');
    expect(await page.evaluate(() => document.activeElement?.textContent)).toBe('Keep');
    await page.keyboard.press('Enter');
    await page.waitForSelector('dialog', { state: 'detached' });
    expect(await page.locator('#tabs button').count()).toBe(4);
    await remove(page, 'bunny.stl');
    await page.waitForSelector('text=Use less material');
    expect(await page.locator('#tabs button').count()).toBe(0);
  });
});

describe('jobs', () => {
  it('are seen in every tab, and stopped in any', async () => {
    const page = await open();
    const other = await openIn(await page.context().newPage());
    await send(page);
    await other.waitForSelector(kShown('models'));
    await page.check('input[name=choice-as][value=modifiers]');
    await page.click('#go');
    await other.click('[role=tab]:has-text("Modifiers")');
    await other.waitForSelector('.stages li');
    await other.click('.progress button');
    await page.waitForSelector('text=Nothing was written');
    await other.waitForSelector('text=Nothing was written');
    // And the next one is not held up by it.
    await page.check('input[name=choice-as][value=voids]');
    await openGroups(page);
    await hollow(page);
    await page.waitForSelector(kShown('jobs'));
    await remove(page, 'bunny.stl');
    await page.context().close();
  });

  it('are not compared any more once another tab has removed them', async () => {
    const page = await open();
    await send(page);
    await openGroups(page);
    await page.fill('#option-scale', '0.8');
    await hollow(page);
    await page.waitForSelector(kShown('jobs'));
    const other = await openIn(await page.context().newPage());
    await page.click('#tab-comparison');
    await page.waitForSelector('.comparison');
    // The solid of the figures is as large as the job's, the one that is shown as it was read; both are as large in the picture.
    expect(await page.textContent('.comparison thead th')).toBe('Solid, 64.6 × 49.4 × 64.8 mm');
    expect(await page.textContent('[aria-label=Left] option')).toBe('Solid as it was read, 80.8 × 61.8 × 81 mm');
    await page.waitForFunction(() => document.querySelectorAll('.side .slot[data-ready]').length === 2);
    const wide = await page.evaluate(() => {
      const across = (side: string): number => {
        const { project, centre, size } = window.aerateStudio![side]!;
        const [a, b] = [-0.5, 0.5].map((k) => project([centre[0], centre[1], centre[2] + k * size[2]]));
        return Math.hypot(a[0] - b[0], a[1] - b[1]);
      };
      return ['left-', 'right-'].map(across);
    });
    expect(Math.abs(wide[0] / wide[1] - 1)).toBeLessThan(0.03);
    await other.click('.head button:has-text("Remove")');
    await page.waitForSelector('#tab-comparison', { state: 'detached' });
    await page.waitForSelector('#view > .slot[data-ready^=models]');
    expect(await page.locator('.comparison').count()).toBe(0);
    await remove(page, 'bunny.stl');
    await page.context().close();
  });

  it('are refused before they begin, in the words of the command line', async () => {
    const page = await open();
    await send(page);
    await page.fill('#option-wall', '-1');
    await page.waitForSelector('#refused .trouble');
    expect(await page.textContent('#refused')).toContain('--wall');
    expect(await page.isDisabled('#go')).toBe(true);
    expect(await page.getAttribute('#option-wall', 'aria-invalid')).toBe('true');
    // A field in a group that is closed is brought to light.
    await openGroups(page);
    await page.fill('#option-wall', '');
    await page.fill('#option-min-radius', '9999');
    await page.evaluate(() => document.querySelectorAll('details.group').forEach((group) => group.removeAttribute('open')));
    await page.waitForSelector('#option-min-radius[aria-invalid=true][aria-describedby=refused]');
    expect(await page.textContent('#refused')).toContain('Smallest radius (--min-radius) 9999 mm');
    expect(await page.isVisible('#option-min-radius')).toBe(true);
    expect(await page.getAttribute('#option-wall', 'aria-invalid')).toBeNull();
    await page.fill('#option-min-radius', '');
    await page.waitForSelector('#estimate dd');
    expect(await page.isEnabled('#go')).toBe(true);
    await remove(page, 'bunny.stl');
    await page.context().close();
    allowRefusals('422');
  });
});

describe('what cannot be used', () => {
  it('is shown with its defect, in the words of the command line', async () => {
    // A square of two triangles: open, and without an inside.
    const open_ = join(folder, 'open.off');
    writeFileSync(open_, 'OFF\n4 2 0\n0 0 0\n20 0 0\n20 20 0\n0 20 5\n3 0 1 2\n3 0 2 3\n');
    const page = await open();
    await send(page, open_);
    const words = (await page.textContent('#model-list .bad')) ?? '';
    expect(words.length).toBeGreaterThan(10);
    expect(await page.locator('#shown-figures .marks button').count()).toBeGreaterThan(0);
    await page.waitForSelector('#refused .trouble');
    const [what] = saidOf(open_);
    expect(words).toContain(what.replace(open_, 'open.off'));
    const advice = (await page.textContent('#refused')) ?? '';
    expect(advice).toContain('cannot be hollowed as it is');
    expect(advice).not.toContain(what.slice(-40));
    // Which fields help, and they do.
    const hole = /"Surface: remesh" and "Largest hole to close: ([\d.]+)"/.exec(advice);
    expect(await page.isDisabled('#go')).toBe(true);
    await openGroups(page);
    await page.selectOption('#option-surface', 'remesh');
    await page.fill('#option-max-hole', hole![1]);
    await page.waitForFunction(() => document.getElementById('refused')?.textContent === '');
    expect(await page.isEnabled('#go')).toBe(true);
    await remove(page, 'open.off');
    await page.context().close();
    allowRefusals('422');
  });

  it('is refused if it cannot be read, and says what to do', async () => {
    const torn = join(folder, 'torn.stl');
    writeFileSync(torn, readFileSync(kBunny).subarray(0, 100_000));
    const page = await open();
    await page.setInputFiles('#chooser', torn);
    const words = (await page.textContent('#uploads .trouble')) ?? '';
    expect(words.length).toBeGreaterThan(20);
    // The same as on the command line, but for the name.
    const said = saidOf(torn).map((line) => sentence(line.replace(torn, 'torn.stl')));
    expect(said).toHaveLength(2);
    for (const line of said) expect(words).toContain(line);
    await page.click('[aria-label="Dismiss torn.stl"]');
    expect(await page.locator('#uploads li').count()).toBe(0);
    await page.context().close();
    allowRefusals('422');
  });

  it('is not even sent if it is larger than the program takes', async () => {
    const page = await open();
    const requests: string[] = [];
    page.on('request', (request) => requests.push(request.url()));
    await page.setInputFiles('#chooser', { name: 'large.stl', mimeType: '', buffer: Buffer.alloc(2_000_001) });
    expect(await page.textContent('#uploads .trouble')).toMatch(/large\.stl has 2 MB.*2 MB at most/);
    await page.setInputFiles('#chooser', { name: 'notes.txt', mimeType: '', buffer: Buffer.from('notes') });
    expect(await page.textContent('#uploads li:last-child .trouble')).toContain('.stl');
    expect(requests.filter((url) => url.includes('/api/models'))).toEqual([]);
    await page.context().close();
  });
});

describe('the page', () => {
  it('asks for the printed address if it has not the token', async () => {
    const page = await (await browser.newContext(kView)).newPage();
    await page.goto(program.address.replace(/#.*/, '#wrong'));
    await page.waitForSelector('text=needs the address that the program printed');
    await page.context().close();
  });

  it('says when the program has gone, and goes on when it is there again', async () => {
    const first = await Program.start();
    const page = await open({ ...kCoarse, viewport: { width: 360, height: 640 } }, first.address);
    await send(page);
    await page.check('input[name=choice-as][value=modifiers]');
    await page.click('#go');
    await page.waitForSelector('.stages li');
    await first.end();
    await page.waitForSelector('#connection:has-text("The program does not answer")');
    // However far down somebody looks.
    await page.evaluate(() => window.scrollTo(0, document.body.scrollHeight));
    const banner = await page.evaluate(() => document.getElementById('connection')!.getBoundingClientRect().toJSON() as DOMRect);
    expect(await page.evaluate(() => window.scrollY)).toBeGreaterThan(200);
    expect(banner.top).toBeGreaterThanOrEqual(0);
    expect(banner.bottom).toBeLessThan(200);
    expect(await page.isVisible('.progress progress')).toBe(false);
    expect(await page.isVisible('.progress button')).toBe(false);
    expect(await page.textContent('.progress [role=status]')).toContain('does not answer');
    const again = await Program.start('--port', first.port);
    // It has another token, which this page cannot know.
    await page.waitForSelector('text=needs the address that the program printed');
    await page.goto(again.address);
    await page.waitForSelector('html[data-connection=open]');
    await page.context().close();
    await again.end();
    messages = messages.filter((message) => !message.startsWith('Failed to load resource'));
  });

  it('has words that can be read, names for all that is filled in, and fits a telephone', async () => {
    for (const options of [{ colorScheme: 'light', ...kCoarse }, { colorScheme: 'dark', viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }] as const) {
      const page = await open(options);
      await send(page);
      await openGroups(page);
      await page.click('[aria-label="About Wall"]');
      await page.waitForSelector('#estimate dd');
      expect(await unreadable(page, '#bar, #setup, #tabs, .panel')).toEqual([]);
      expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(options.colorScheme === 'dark' ? 390 : 1100);
      await remove(page, 'bunny.stl');
      await page.context().close();
    }
  });

  it('shows what has the focus, in windows that are small too', async () => {
    for (const viewport of [{ width: 360, height: 640 }, { width: 1100, height: 600 }]) {
      const page = await open({ ...kCoarse, viewport });
      await send(page);
      await openGroups(page);
      await page.waitForSelector('#start:not([aria-busy]) #estimate dd');
      await page.focus('#drop');
      const hidden: string[] = [];
      let stops = 0;
      for (let isIn = true; isIn; ++stops) {
        await page.keyboard.press('Tab');
        await page.evaluate(() => new Promise((done) => requestAnimationFrame(done)));
        const at = await page.evaluate(() => {
          const element = document.activeElement!;
          const bar = document.getElementById('start')!;
          const { top, bottom } = element.getBoundingClientRect();
          const end = bar.contains(element) || !bar.classList.contains('stays') ? window.innerHeight : bar.getBoundingClientRect().top;
          const name = element.id || element.getAttribute('aria-label') || element.textContent;
          return { isIn: document.getElementById('setup')!.contains(element), name, isSeen: top >= -1 && bottom <= end + 1, where: [top, bottom, end].map(Math.round).join(' ') };
        });
        isIn = at.isIn;
        if (isIn && !at.isSeen) hidden.push(`${at.name}: ${at.where}`);
      }
      expect(hidden).toEqual([]);
      expect(stops).toBeGreaterThan(50);
      await remove(page, 'bunny.stl');
      await page.context().close();
    }
  });

  it('is used without a pointer', async () => {
    const page = await open();
    await send(page);
    await page.focus('#option-wall');
    await page.keyboard.type('2.5');
    await page.waitForFunction(() => document.getElementById('command')?.textContent?.includes('2.5'));
    await page.check('input[name=choice-shape][value=spheres]');
    await openGroups(page);
    await page.fill('#option-min-radius', '3');
    await page.keyboard.press('Enter');
    await page.waitForSelector(kShown('jobs'));
    await page.focus('[role=tab][aria-selected=true]');
    await page.keyboard.press('ArrowLeft');
    await page.waitForSelector(kShown('models'));
    expect(await page.evaluate(() => document.activeElement?.textContent)).toBe('Model');
    await remove(page, 'bunny.stl');
    await page.context().close();
  });
});
