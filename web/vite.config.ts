import { defineConfig } from 'vitest/config';
import { singleFile } from './single-file';

// `vite build` makes the page of --view, which is opened from disk, where nothing lies beside it; `vite build --mode studio`
// makes the page, the script and the style of `aerate studio`, which it serves under these names.
export default defineConfig(({ mode }) => {
  const isStudio = mode === 'studio';
  const named = { entryFileNames: 'studio.js', assetFileNames: 'studio[extname]' };
  return {
    plugins: isStudio ? [] : [singleFile('view.html')],
    build: {
      target: 'es2022',
      outDir: process.env.AERATE_WEB_OUT ?? 'dist',
      emptyOutDir: false,
      cssCodeSplit: false,
      modulePreload: false,
      chunkSizeWarningLimit: 1000,
      rollupOptions: isStudio ? { input: 'studio.html', output: named } : { input: 'view.html' },
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
  };
});
