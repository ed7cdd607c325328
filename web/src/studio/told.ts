// What the program tells the page (docs/studio.md, "The interface").

export interface OptionRow {
  readonly name: string;
  readonly kind: 'number' | 'text' | 'choice' | 'flag' | 'list';
  readonly unit: string;
  readonly default: string | null;
  readonly choices?: readonly string[];
  readonly description: string;
  readonly group: string;
  readonly off?: boolean; // a flag that can be false, too
  readonly bare?: boolean; // may be given without a value
}

export interface ProcessRow {
  readonly option: string | null; // that sets it, if one does
  readonly name: string;
  readonly value: number | string | null; // null: the process has no such limit
  readonly unit: string;
  readonly source: string | null;
}

export interface Process {
  readonly name: string;
  readonly title: string;
  readonly material: string;
  readonly rows: readonly ProcessRow[];
}

export type Value = string | boolean | readonly string[];
export type Options = Readonly<Record<string, Value>>;

// In the words of the command line.
export interface Trouble {
  readonly what: string;
  readonly hint?: string;
  readonly exit?: number;
}

export interface Input {
  readonly format: string;
  readonly triangles: number;
  readonly filled_volume_mm3: number;
  readonly box: { readonly lower_mm: readonly number[]; readonly upper_mm: readonly number[] };
}

export interface Model {
  readonly id: string;
  readonly name: string;
  readonly bytes: number;
  readonly report: { readonly input: Input };
  readonly usable: boolean;
  readonly use: string;
}

export type JobState = 'waiting' | 'running' | 'done' | 'failed' | 'stopped';

export interface JobFile {
  readonly form: string;
  readonly name: string;
  readonly bytes: number;
}

export interface Job {
  readonly id: string;
  readonly model: string;
  readonly options: Options;
  readonly state: JobState;
  readonly waitingBefore?: number;
  readonly stage?: string | null;
  readonly progress?: number | null;
  readonly notices?: readonly string[];
  readonly error?: Trouble | null;
  readonly command: string;
  readonly files?: readonly JobFile[];
  readonly seconds?: number;
}

export interface Estimate {
  readonly command: string;
  readonly rows: readonly { readonly label: string; readonly value: string }[];
}

export interface Limits {
  readonly bodyBytes: number;
  readonly models: number;
  readonly jobs: number;
  readonly formats: readonly string[];
}

export interface Told {
  readonly version: string;
  readonly limits: Limits;
  readonly options: readonly OptionRow[];
  readonly processes: readonly Process[];
  readonly models: readonly Model[];
  readonly jobs: readonly Job[];
}

// What is read of a report (docs/report.md); all of it is there to download.
export interface Report {
  readonly input: Input;
  readonly process: { readonly name: string };
  readonly output: { readonly bytes: number; readonly triangles: number };
  readonly voids: { readonly shape: string; readonly count: number; readonly min_radius_mm: number; readonly max_radius_mm: number };
  readonly measured: { readonly wall_mm: number | null; readonly gap_mm: number | null };
  readonly volume: { readonly before_mm3: number; readonly after_mm3: number | null };
  readonly modifiers: { readonly infill_percent: number; readonly volume_mm3: number; readonly volume_percent: number } | null;
  readonly strength_and_balance: { readonly relative_stiffness_upper_bound: number } | null;
  readonly print: {
    readonly infill_percent: number;
    readonly filament_before_mm3: number;
    readonly filament_after_mm3: number;
    readonly verdict: {
      readonly infill_percent: number;
      readonly filament_before_mm3: number;
      readonly filament_after_mm3: number;
    } | null;
  } | null;
  readonly material: {
    readonly name: string;
    readonly mass_before_g: number;
    readonly mass_after_g: number;
    readonly cost_before: number;
    readonly cost_after: number;
  } | null;
  readonly seconds: number;
}
