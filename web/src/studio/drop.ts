// Models can be dropped anywhere on the page.

const hasFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes('Files') ?? false;

export function listenToDrops(over: HTMLElement, onFiles: (files: FileList) => void): void {
  let inside = 0; // elements that are entered and not left
  const show = (): void => {
    over.hidden = inside <= 0;
  };
  window.addEventListener('dragenter', (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    ++inside;
    show();
  });
  window.addEventListener('dragleave', (event) => {
    if (!hasFiles(event)) return;
    --inside;
    show();
  });
  window.addEventListener('dragover', (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    if (event.dataTransfer) event.dataTransfer.dropEffect = 'copy';
  });
  window.addEventListener('drop', (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    inside = 0;
    show();
    if (event.dataTransfer) onFiles(event.dataTransfer.files);
  });
}
