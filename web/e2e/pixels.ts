import type { Page } from 'playwright-core';

export type Place = readonly [number, number]; // CSS pixels on the canvas

interface Look {
  readonly colour: readonly number[]; // red, green, blue, opacity at the place
  readonly colours: number; // that are clearly not each other, round it
  readonly covered: number; // share of the canvas on which anything is drawn
}

// What a canvas showed, as the browser reads its own PNG.
export class Pixels {
  constructor(
    private readonly url: string,
    private readonly page: Page,
    private readonly canvas: string, // its id
  ) {}

  private async look(place: Place = [0, 0]): Promise<Look> {
    return this.page.evaluate(
      async ([url, [x, y], id]) => {
        const kReach = 14;
        const image = new Image();
        image.src = url;
        await image.decode();
        const canvas = document.createElement('canvas');
        canvas.width = image.width;
        canvas.height = image.height;
        const context = canvas.getContext('2d', { willReadFrequently: true })!;
        context.drawImage(image, 0, 0);
        const { data } = context.getImageData(0, 0, image.width, image.height);
        const scale = image.width / document.getElementById(id)!.clientWidth;
        const at = [Math.round(x * scale), Math.round(y * scale)];
        const first = (atX: number, atY: number): number => 4 * (atY * image.width + atX);
        let drawn = 0;
        for (let i = 3; i < data.length; i += 4) drawn += data[i] > 0 ? 1 : 0;
        const seen = new Set<string>();
        for (let dy = -kReach; dy <= kReach; ++dy) {
          for (let dx = -kReach; dx <= kReach; ++dx) {
            const i = first(at[0] + dx, at[1] + dy);
            if (data[i + 3] === 255) seen.add([0, 1, 2].map((k) => data[i + k] >> 6).join());
          }
        }
        const here = first(at[0], at[1]);
        return { colour: [...data.slice(here, here + 4)], colours: seen.size, covered: drawn / (data.length / 4) };
      },
      [this.url, place, this.canvas] as const,
    );
  }

  async opacity(place: Place): Promise<number> {
    return (await this.look(place)).colour[3];
  }

  // As voids are.
  async isBlue(place: Place): Promise<boolean> {
    const [red, green, blue] = (await this.look(place)).colour;
    return blue > red + 30 && blue > green;
  }

  async coloursRound(place: Place): Promise<number> {
    return (await this.look(place)).colours;
  }

  async covered(): Promise<number> {
    return (await this.look()).covered;
  }

  differs(other: Pixels): boolean {
    return this.url !== other.url;
  }
}

export async function pixelsOf(page: Page, canvas = 'canvas'): Promise<Pixels> {
  // What was asked for is drawn with the next frame.
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const url = await page.evaluate((id) => (document.getElementById(id) as HTMLCanvasElement).toDataURL(), canvas);
  return new Pixels(url, page, canvas);
}
