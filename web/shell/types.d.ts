// Types shared by the page's scripts: the program's exports, what it calls back, the session's events and effects, and
// `window.gaitway`.

/** A file that is opened. */
export interface NamedFile {
  /** Path inside the folder that was chosen or dropped, or the file's own name. */
  name: string;
  content: Blob | ArrayBuffer | Uint8Array<ArrayBuffer>;
}

/** Anything `gaitway.open` takes. */
export type Openable = string | URL | File | NamedFile | Record<string, Blob | ArrayBuffer | ArrayBufferView>;

/** What the session knows of something that is opened: a URL, or a file that the page keeps by this number. */
export type Item = string | { id: number; name: string };

/** An item as the program takes it. */
export type ReadItem = string | [name: string, bytes: Uint8Array<ArrayBuffer>];

/** `motion`: borrow from the files, whatever they are. */
export type Role = "motion" | undefined;

export type Backend = "webgpu" | "webgl2";

/** What kind of failure an error is; see `ErrorCode` in src/files/error.rs. */
export type ErrorCode = "not-found" | "cross-origin" | "unsupported" | "malformed" | "too-large" | "cancelled" | "lost-device" | "no-graphics";

/** What the calls of `window.gaitway` reject with. */
export interface GaitwayError extends Error {
  code: ErrorCode;
}

/** What was opened. */
export type Kind = "model" | "motion" | "light" | "map";

export interface Failure {
  code: ErrorCode | null;
  message: string;
}

/** How a task of the session has ended; see crates/session/src/event.rs. */
export type TaskResult =
  | { event: "read" }
  | { event: "opened"; kind: Kind }
  | { event: "followed"; read: string[]; problems: string[] }
  | { event: "lacking"; names: string[] }
  | { event: "failed"; failure: Failure };

/** What the page tells the session; see crates/session/src/event.rs. */
export type SessionEvent =
  | { event: "launch" | "loaded" | "settled" | "tryAgain" | "later" }
  | { event: "started"; problems: string[] }
  | { event: "stopped"; reason: string }
  | { event: "cannotRun"; failure: Failure }
  | { event: "hold"; items: Item[] }
  | { event: "open"; request: number | null; by: "hand" | "script" | "frame"; items: Item[]; role: "any" | "motion" }
  | { event: "moved"; link: string; state: { number: number | null; own: boolean } }
  | { event: "changed" | "share" | "visit"; link: string }
  | { event: "applied"; read: string[] }
  | { event: "imagesFailed"; problem: string }
  | (TaskResult & { task: number });

/** What the session has the page do; see crates/session/src/effect.rs. */
export type Effect =
  | { effect: "run"; link: string; model: Item[]; motion: Item[]; isPrivate: boolean }
  | { effect: "restart" | "loadImages" | "closeAsk" | "closeReport" | "forgetProblem" | "hideGallery" | "focus" | "settleSoon" }
  | { effect: "read" | "findReferences"; task: number; items: Item[] }
  | { effect: "show"; task: number; items: Item[]; role: "any" | "motion"; isPrivate: boolean; isByHand: boolean }
  | { effect: "forget"; task: number }
  | { effect: "follow"; task: number; link: string; reload: boolean }
  | { effect: "push"; state: { number: number; own: boolean }; link: string }
  | { effect: "replace"; state: { number: number; own: boolean }; link: string | null }
  | { effect: "ask"; files: string[]; others: string | null; isOwn: boolean }
  | { effect: "report"; problems: string[]; title: string; rest: string; without: string }
  | { effect: "notify"; text: string }
  | { effect: "sayProblem" | "refuse"; message: string }
  | { effect: "announce"; task: number; kind: Kind }
  | { effect: "reply"; request: number; task: number }
  | { effect: "reject"; request: number; failure: Failure }
  | { effect: "share"; link: string; embedded: string; files: string[] }
  | { effect: "visit"; link: string }
  | { effect: "release"; files: number[] };

/** What does each effect. */
export type Performers = { [Name in Effect["effect"]]: (effect: Effect & { effect: Name }) => void };

/** What the page may read of the session at any time; see crates/session/src/effect.rs. */
export interface Facts {
  link: string;
  isLocal: boolean;
  need: string | null;
  isPrivate: boolean;
  seenPrivate: number;
}

/** A file of a saved page. */
export type PageFile = [name: string, bytes: Uint8Array<ArrayBuffer>];

/** A scene that a page is saved with; see crates/scene/src/editor/scene.rs. */
export interface PageScene {
  title: string;
  link: string;
  model: PageFile[];
  motion: PageFile[];
  /** Images of the model have to be transcoded. */
  hasKtx2: boolean;
}

/** What the program calls; see src/web/shell.rs. */
export interface ShellCalls {
  readonly renderer: Backend;
  choose(role: "any" | "motion"): void;
  gallery(): void;
  setModal(isOpen: boolean): void;
  readonly hasGallery: boolean;
  savePage(title: string, link: string, model: PageFile[], motion: PageFile[], hasKtx2: boolean): void;
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
  warn(message: string, code?: ErrorCode): void;
  /** Reports a problem to the page around this one. Returns whether that is told, instead of the user. */
  report(problem: string): boolean;
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
  close_menu(): boolean;
  open(items: ReadItem[], role: "any" | "motion", isPrivate: boolean, isByHand: boolean): Promise<string>;
  follow_link(link: string, again: boolean): Promise<string>;
  apply(partial: string): Promise<string>;
  missing_files(items: ReadItem[]): string[];
  refuse(problem: string): void;
  notify(notice: string): void;
  state(): string;
  pose(): string;
  stats(): string;
  summary(): string;
  screenshot(): Promise<Uint8Array<ArrayBuffer>>;
  video_frame(index: number): Promise<Uint8Array<ArrayBuffer>>;
  gltf_file(model: number, uri?: string): Uint8Array<ArrayBuffer>;
  session_of(link: string, number: number | undefined, own: boolean): string;
  session_after(session: string, event: string): string;
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
  /** `true`: as another page embeds it, with the transport and a button that opens the view in a page of its own. */
  embed: boolean | "transport" | "viewport";
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
    answer(name: string, input: Uint8Array<ArrayBuffer>): Promise<Uint8Array>;
    convert(name: string, input: Uint8Array<ArrayBuffer>): Promise<Uint8Array>;
    run(name: string, module: Uint8Array<ArrayBuffer>, input: Uint8Array<ArrayBuffer>): Promise<Uint8Array>;
  };
  /** For the program: whether the user may drop files. */
  allowsFiles(): boolean;
  /** Resolves once the first image is on screen, with all of its model that could be loaded; a new promise after each restart. */
  readonly ready: Promise<void>;
  open(items: Openable | Openable[] | FileList, options?: { as?: Role }): Promise<InspectDocument>;
  apply(partial: object): Promise<void>;
  screenshot(): Promise<Blob>;
  /** Returns a link to the current view, in a page of its own. */
  toLink(): Promise<string>;
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
    /** `what`: the program or a file. */
    "gaitway:progress": CustomEvent<{ what: string; share: number }>;
    "gaitway:problem": CustomEvent<{ message: string; code: ErrorCode | null }>;
  }
}
