import { defineConfig } from 'vitest/config';
import { singleFile } from './single-file';

export default defineConfig({
  // Opened from disk, where nothing lies beside the page.
  plugins: [singleFile('view.html')],
  build: {
    target: 'es2022',
    outDir: process.env.AERATE_WEB_OUT ?? 'dist',
    emptyOutDir: false,
    cssCodeSplit: false,
    modulePreload: false,
    rollupOptions: { input: 'view.html' },
  },
  test: {
    projects: [
      { test: { name: 'unit', include: ['tests/**/*.test.ts'] } },
      {
        test: {
          name: 'e2e',
          include: ['e2e/**/*.test.ts'],
          testTimeout: 60_000,
          hookTimeout: 60_000,
          poolOptions: { forks: { singleFork: true } },
        },
      },
    ],
  },
});
