/** A URL, relative to the page, a file, or the contents of files by name. */
export type Openable = string | URL | File | { name: string; content: Blob } | Record<string, Blob | ArrayBuffer | ArrayBufferView>;

/** What kind of failure an error is. */
export type ErrorCode =
  | "not-found"
  | "cross-origin"
  | "unsupported"
  | "malformed"
  | "too-large"
  | "cancelled"
  | "lost-device"
  | "no-graphics";

/** What methods reject with. */
export interface ViewerError extends Error {
  code?: ErrorCode;
}

/** An attribute's value; `null` removes it. Properties return the attribute's text. */
type Text = string | number | null;
/** A list is written as JSON into the attribute. */
type List = string | string[] | null;
type Flag = string | boolean | null;

/** Attributes, as properties. docs/viewer.md describes them, docs/links.md the keys of the link. */
export interface ViewerAttributes {
  model: List;
  motion: List;
  map: List;
  unmapped: Text;
  root: Text;
  feet: Text;
  contacts: Text;
  scene: Text;
  /** Empty for the rest pose. */
  clip: Text;
  t: Text;
  fade: Text;
  mirror: List;
  copy: List;
  rename: List;
  change: List;
  layers: List;
  speed: Text;
  loop: Text;
  range: Text;
  skinning: Text;
  morph: Text;
  expression: Text;
  look: Text;
  springs: Flag;
  pin: List;
  names: Text;
  channel: Text;
  show: Text;
  joint: Text;
  vertex: Text;
  camera: Text;
  fov: Text;
  follow: Flag;
  turntable: Text;
  variant: Text;
  up: Text;
  exposure: Text;
  tonemap: Text;
  environment: Text;
  light: Text;
  background: Text;
  /** The key `play`. */
  autoplay: Flag;
  /** The key `pose`. */
  joints: Text;
  /** The key `hidden`. */
  hide: Text;
  /** The key `key`, the attribute `key-light`. */
  keyLight: Text;

  /** The folder of Gaitway's page; by default, the one around the module's. */
  base: Text;
  /** Forces a back end. */
  renderer: "webgpu" | "webgl2" | null;
  /** Lets users drop and choose files. */
  drop: boolean;
  /** Shows the transport. */
  controls: boolean;
  /** The URL of an image that is shown until the model is. */
  poster: Text;
  /** Describes the view to screen readers. */
  alt: Text;
  loading: "eager" | "lazy" | null;
  reveal: "auto" | "interaction" | null;
}

export interface ViewerEvents {
  /** From 0 to 1. */
  progress: CustomEvent<{ progress: number }>;
  /** The first image of a model is shown. */
  load: CustomEvent<null>;
  /** The view has changed. */
  change: CustomEvent<null>;
  error: CustomEvent<{ message: string; code?: ErrorCode }>;
}

// An interface of its own, since HTMLElement's `autofocus` and the like mustn't be narrowed.
export interface GaitwayViewer extends ViewerAttributes {}

export class GaitwayViewer extends HTMLElement {
  /** The folder of Gaitway's page for all viewers without the attribute `base`. */
  static base: string;
  static readonly observedAttributes: readonly string[];

  /** Opens a model, or a motion for the one that is shown. Resolves to the document of `gaitway inspect --json`. */
  open(items: Openable | Openable[] | FileList, options?: { as?: "motion" }): Promise<any>;
  /** Sets keys of the link; resolves after the frame that shows the result. */
  apply(partial: Record<string, unknown>): Promise<void>;
  /** Returns all keys of the link. */
  state(): Promise<Record<string, any>>;
  /** Returns the document of `gaitway pose --json`. */
  pose(): Promise<any>;
  /** Returns a PNG. */
  screenshot(): Promise<Blob>;
  play(): Promise<void>;
  pause(): Promise<void>;
  /** Returns a link to the view as it is, in a page of its own. */
  toLink(): Promise<string>;

  addEventListener<Type extends keyof ViewerEvents>(type: Type, listener: (this: GaitwayViewer, event: ViewerEvents[Type]) => unknown, options?: boolean | AddEventListenerOptions): void;
  addEventListener<Type extends keyof HTMLElementEventMap>(type: Type, listener: (this: HTMLElement, event: HTMLElementEventMap[Type]) => unknown, options?: boolean | AddEventListenerOptions): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject, options?: boolean | AddEventListenerOptions): void;
  removeEventListener<Type extends keyof ViewerEvents>(type: Type, listener: (this: GaitwayViewer, event: ViewerEvents[Type]) => unknown, options?: boolean | EventListenerOptions): void;
  removeEventListener(type: string, listener: EventListenerOrEventListenerObject, options?: boolean | EventListenerOptions): void;
}

declare global {
  interface HTMLElementTagNameMap {
    "gaitway-viewer": GaitwayViewer;
  }
}
