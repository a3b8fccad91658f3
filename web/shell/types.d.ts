// Types shared by the page's scripts: the program's exports, what it calls back, and `window.gaitway`.

/** What the program is asked to open: a URL, or a named file. */
export type Item = string | NamedFile;

export interface NamedFile {
  /** Path inside the folder that was chosen or dropped, or the file's own name. */
  name: string;
  content: Blob | ArrayBuffer | Uint8Array<ArrayBuffer>;
}

/** Anything `gaitway.open` takes. */
export type Openable = string | URL | File | NamedFile | Record<string, Blob | ArrayBuffer | ArrayBufferView>;

/** An item as the program takes it. */
export type ReadItem = string | [name: string, bytes: Uint8Array<ArrayBuffer>];

/** `motion`: borrow from the files, whatever they are. */
export type Role = "motion" | undefined;

export type Backend = "webgpu" | "webgl2";

/** What kind of failure an error is; see `ErrorCode` in src/files/error.rs. */
export type ErrorCode = "not-found" | "cross-origin" | "unsupported" | "malformed" | "too-large" | "cancelled" | "lost-device";

/** What the calls of `window.gaitway` reject with. */
export interface GaitwayError extends Error {
  code: ErrorCode;
}

/** A `model`, `motion` or `light` of a link; see `LinkedFile` in crates/session/src/link.rs. */
export interface LinkedFile {
  role: "model" | "motion" | "light";
  name: string;
  member: string;
  isToBring: boolean;
}

/** What the program calls; see src/web/shell.rs. */
export interface ShellCalls {
  choose(role: "any" | "motion"): void;
  gallery(): void;
  setModal(isOpen: boolean): void;
  save(name: string, bytes: Uint8Array<ArrayBuffer>): void;
  record(name: string, width: number, height: number, framesPerSec: number, frameCount: number, isTransparent: boolean, format: "video" | "gif" | "images"): Promise<string | undefined>;
  cancelRecording(): void;
  validate(model: number): Promise<string>;
  share(link: string): void;
  visit(address: string): void;
  hasFullscreen(): boolean;
  toggleFullscreen(): void;
  theme(): string;
  setTheme(theme: string): void;
  progress(name: string, received: number, total: number): void;
  changed(link: string): void;
  warn(message: string): void;
  mirror(tree: string): void;
  stopped(message: string): void;
}

/** Something that the panels show; see src/app/mirror.rs. */
export interface MirrorEntry {
  id: string;
  role: string;
  in?: string;
  name?: string;
  value?: string;
  description?: string;
  now?: number;
  min?: number;
  max?: number;
  checked?: "true" | "false" | "mixed";
  expanded?: boolean;
  disabled?: true;
  focusable?: true;
  level?: number;
  at?: number;
  of?: number;
  row?: number;
  list?: string;
  /** Left, top, width and height in CSS pixels. */
  rect?: [number, number, number, number];
}

/** The program's exports as wasm-bindgen writes them; see src/web. Documents are JSON text. */
export interface Bindings {
  run(
    canvas: HTMLCanvasElement,
    link: string,
    items: ReadItem[],
    motionItems: ReadItem[],
    isPrivate: boolean,
    shell: ShellCalls,
  ): Promise<string>;
  font(): Uint8Array<ArrayBuffer>;
  complete(): Promise<string>;
  complete_again(): Promise<string>;
  drawn(): Promise<void>;
  begin(): void;
  destroy(): void;
  mirror_act(id: string, action: "focus" | "blur" | "click" | "more" | "less" | "set", value?: number | string): void;
  mirror_key(name: string, code: string, pressed: boolean, alt: boolean, ctrl: boolean, shift: boolean, meta: boolean): void;
  mirror_focus(hasFocus: boolean): void;
  open(items: ReadItem[], role: Role, isPrivate: boolean, isByHand: boolean): Promise<string>;
  follow_link(link: string, again: boolean): Promise<string>;
  apply(partial: string): Promise<string>;
  missing_files(items: ReadItem[]): string[];
  refuse(problem: string): void;
  notify(notice: string): void;
  is_private(): boolean;
  state(): string;
  pose(): string;
  stats(): string;
  summary(): string;
  screenshot(): Promise<Uint8Array<ArrayBuffer>>;
  video_frame(index: number): Promise<Uint8Array<ArrayBuffer>>;
  gltf_file(model: number, uri?: string): Uint8Array<ArrayBuffer>;
  linked_files(link: string): string;
  shown_files(link: string): string;
  public_link(link: string, local: string[]): string;
  embedded_link(link: string): string;
  link_without_missing(link: string): string;
  link_with_missing(link: string, asking: string): string;
  link_with_files(link: string, names: string[]): string;
  most_similar_link(link: string, others: string[]): number | undefined;
  /** Only in a build for benches/web. */
  bench_characters?(bytes: Uint8Array, clip: string, characters: number, frames: number): number;
  bench_load?(bytes: Uint8Array): Promise<void>;
  bench_retarget?(model: Uint8Array, motion: Uint8Array, clip: string, rounds: number): number;
}

/** The document that `gaitway inspect --json` prints. */
export interface InspectDocument {
  files: string[];
  format: string;
  joints: number;
  vertices: number;
  triangles: number;
  clips: { index: number; name: string; duration_secs: number; channels: number }[];
  borrowed_clips?: { name: string }[];
  bounds: { min: number[]; max: number[] };
  warnings: { code: string; message: string; where: string }[];
}

/** The document that `gaitway pose --json` prints. */
export interface PoseDocument {
  clip: string | null;
  time_secs: number;
  nodes: { node: number; name: string; world: number[] }[];
  meshes: { node: number; mesh: number; primitive: number; positions: number[]; normals: number[] }[];
}

export interface Stats {
  backend: Backend;
  frame_ms: number;
  cpu_ms: number;
  draw_calls: number;
  triangles: number;
  joints: number;
  characters: number;
  frames: number;
}

/** Keys of the link. */
export interface State {
  model: string[];
  motion: string[];
  map: string[];
  clip: string | null;
  t: number;
  play: boolean;
  show: string;
  channel: string;
  hidden: string;
  copy: string[];
  rename: string[];
  change: string[];
  layers: string[];
  camera: string;
  turntable: number;
  pose: string;
  pin: string[];
  names: string;
  embed: boolean;
  exposure: number;
  root: string | null;
  feet: string | null;
  joint: number | null;
}

/** `window.gaitway`, the script interface. */
export interface Gaitway {
  /** Files of each sample by the name after `sample:`, as URLs relative to the page. */
  samples: Record<string, string[]>;
  /** For the program: see parts.js. */
  parts: {
    url(name: string): string | undefined;
    convert(name: string, input: Uint8Array<ArrayBuffer>): Promise<Uint8Array>;
    run(name: string, module: Uint8Array<ArrayBuffer>, input: Uint8Array<ArrayBuffer>): Promise<Uint8Array>;
  };
  /** Resolves once the first image is on screen, with all of its model that could be loaded; a new promise after each restart. */
  readonly ready: Promise<void>;
  open(items: Openable | Openable[] | FileList, options?: { as?: Role }): Promise<InspectDocument>;
  apply(partial: object): Promise<void>;
  screenshot(): Promise<Blob>;
  /** Answered at once while the program runs, otherwise as a promise. */
  state(): State | Promise<State>;
  pose(): PoseDocument | Promise<PoseDocument>;
  stats(): Stats | Promise<Stats>;
  benchCharacters?(bytes: Uint8Array, clip: string, characters: number, frames: number): number;
  benchLoad?(bytes: ArrayBuffer): Promise<void>;
  benchRetarget?(model: Uint8Array, motion: Uint8Array, clip: string, rounds: number): number;
}

/** A program's download, which can be cancelled. */
export interface ProgramRequest {
  backend: Backend;
  response: Promise<Response>;
  abort: () => void;
}

declare global {
  interface Window {
    gaitway: Gaitway;
    /** The program that the page's head has requested, until the shell takes it over. */
    earlyRequest?: ProgramRequest;
    /** Files that the system opens with the installed page. */
    launchQueue?: { setConsumer(consumer: (launch: { files: FileSystemFileHandle[] }) => void): void };
  }
  interface WindowEventMap {
    "gaitway:loading": CustomEvent<{ link: string; isLocal: boolean }>;
    "gaitway:change": CustomEvent<null>;
    "gaitway:part-loaded": CustomEvent<null>;
  }
}
