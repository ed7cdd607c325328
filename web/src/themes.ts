import type { Stage, Theme } from './stage';

export const kLight: Theme = {
  cut: [0.93, 0.78, 0.5],
  hatch: [0.55, 0.38, 0.14],
  other: [0.55, 0.74, 0.92],
  chosen: [0.86, 0.15, 0.42],
  mark: [0.78, 0.09, 0.16],
};
const kDark: Theme = {
  cut: [0.62, 0.47, 0.24],
  hatch: [0.9, 0.76, 0.48],
  other: [0.2, 0.4, 0.6],
  chosen: [1, 0.36, 0.58],
  mark: [0.85, 0.1, 0.18],
};

export const themeNow = (): Theme => (window.matchMedia('(prefers-color-scheme: dark)').matches ? kDark : kLight);

export function listenToTheme(stage: Stage, signal: AbortSignal): void {
  const paint = (): void => stage.paint(themeNow());
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', paint, { signal });
  paint();
}
