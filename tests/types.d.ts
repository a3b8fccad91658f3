// Types that only the tests and benchmarks need.

/** The parts of a glTF document that the tests look at. */
export interface GltfJson {
  asset: { version: string; minVersion?: string };
  extensionsUsed?: string[];
  extensionsRequired?: string[];
  accessors: { count: number; bufferView: number; componentType: number; byteOffset?: number }[];
  animations: { channels: GltfChannel[] }[];
  buffers: { byteLength: number; uri?: string }[];
  bufferViews: { byteOffset?: number }[];
  images?: object[];
  materials?: { doubleSided?: boolean }[];
  textures?: object[];
  meshes: { primitives: GltfPrimitive[] }[];
  skins?: { joints: number[] }[];
  nodes: { name?: string; mesh?: number; weights?: number[]; rotation?: number[]; extensions?: object }[];
}

export interface GltfChannel {
  sampler: number;
  target: { node?: number; path: string; extensions?: { KHR_animation_pointer?: { pointer: string } } };
}

export interface GltfPrimitive {
  attributes: Record<string, number>;
  indices?: number;
  material?: number;
  mode?: number;
  extras?: { name?: string };
}

/** What `gaitway retarget --json` prints. */
export interface RetargetReport {
  clip: string;
  duration_secs: number;
  figures: { orientation_error_degrees_mean: number };
}

/** An answer of an embedded frame; its result depends on the call. */
export interface Reply {
  result?: any;
  error?: string;
  code?: string;
}

declare global {
  interface Window {
    /** The three.js side of benches/web. */
    bench: import("../benches/web/three.mjs").Bench;
    /** The renderers of tests/reference, which return PNGs as data URLs. */
    reference: import("./reference/page.mjs").Reference;
    /** Files of benches/web. */
    fetched: Uint8Array[];
    /** When the page's last frame was done. */
    drawnMs: number;
    /** How many files benches/web has opened. */
    opened: number;
    /** Tasks of 50 ms and more, noted by benches/web/first.mjs. */
    longTasks: PerformanceEntry[];
    /** Changes counted by page.test.mjs. */
    changes: number;
    /** Of the page around an embedded one in link.test.mjs. */
    call(...request: unknown[]): Promise<Reply>;
    events: string[];
    askFromAside(call: string): Promise<string>;
    openBytes(name: string, url: string): Promise<Reply>;
  }
}
