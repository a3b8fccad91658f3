// The element `<gaitway-viewer>`: Gaitway's page in a frame, described by attributes. The frame keeps its scripts, styles and keyboard
// apart from those of the page around it and, on another origin, hides the files that users drop into it. Calls are messages
// (web/shell/embed.js). Until a viewer is needed, this file and a poster are all that is loaded. Importing this on a server does nothing.

/** @typedef {import("./gaitway.d.ts").ErrorCode} ErrorCode */
/** @typedef {import("./gaitway.d.ts").Openable} Openable */

/** Attributes with the names of their link keys. */
const KEYS =
  "model motion map unmapped root feet contacts scene clip t fade mirror copy rename change layers speed loop range skinning morph expression look springs pin names channel show joint vertex camera fov follow turntable variant up exposure tonemap environment light background".split(
    " ",
  );
/**
 * The link key of each attribute. The names of the last four keys are taken by HTML, a framework or a method.
 * @type {Record<string, string>}
 */
const KEY_OF = { ...Object.fromEntries(KEYS.map((key) => [key, key])), autoplay: "play", joints: "pose", hide: "hidden", "key-light": "key" };
const FLAGS = ["autoplay", "springs", "follow"];
/**
 * Keys whose values are URLs, with a pattern for values that aren't: joint maps and their compact form, light presets.
 * @type {Record<string, RegExp>}
 */
const URLS = { model: /^$/, motion: /^$/, map: /^(\{|[12]\.[\da-f]{8}\.)/i, light: /^[^./:]*$/ };

/** Attributes that need a new frame when they change. */
const OF_FRAME = ["base", "renderer", "drop"];
const OTHERS = [...OF_FRAME, "controls", "poster", "alt", "loading", "reveal"];
/** Attributes without a value, which are properties with a boolean. */
const BOOLEANS = ["controls", "drop"];
/** The attributes that say what the frame shows. */
const ALL = [...Object.keys(KEY_OF), "controls"];
/** Attributes that name the files; the others are about these. */
const SOURCES = ["model", "motion"];
/** The view of a new model before its attributes are applied: paused, so that a clip begins where it should. */
const BARE = { ...Object.fromEntries(Object.values(KEY_OF).map((key) => [key, null])), embed: "viewport", play: false };

/** @param {string} name */
const camelCase = (name) => name.replace(/-(.)/g, (_, letter) => letter.toUpperCase());

const STYLE = `
  :host { display: block; position: relative; overflow: hidden; aspect-ratio: 4 / 3; background: var(--gaitway-background, none); }
  :host([hidden]) { display: none; }
  iframe, [part="poster"], ::slotted([slot="poster"]), button { position: absolute; inset: 0; width: 100%; height: 100%; margin: 0; border: 0; object-fit: contain; }
  iframe { opacity: 0; color-scheme: light dark; }
  button { background: none; cursor: pointer; }
  button::after { content: "▶"; padding: 0.6em 0.7em 0.6em 0.85em; border-radius: 50%; background: var(--gaitway-progress-color, #3d5ce0); color: #fff; font: 24px/1 system-ui; }
  button:focus-visible { outline: 3px solid var(--gaitway-progress-color, #3d5ce0); outline-offset: -3px; }
  [part="progress"] { position: absolute; inset: auto 0 0; height: var(--gaitway-progress-height, 4px); background: var(--gaitway-progress-track, #8883); }
  [part="progress"] > div { width: calc(100% * var(--gaitway-progress)); height: 100%; background: var(--gaitway-progress-color, #3d5ce0); transition: width 0.2s; }
  [part="error"] { position: absolute; inset: auto 0 0; margin: 0; padding: 0.75em 1em; background: var(--gaitway-error-background, #fff); color: var(--gaitway-error-color, #b42a1f); font: 14px/1.4 system-ui, sans-serif; overflow-wrap: anywhere; }
  [part="poster"]:not([src]), .shown > :not(iframe), .waiting > :not(.poster, button), .loading > :is(button, .error), .failed > :is(button, .progress) { display: none; }
  .shown > iframe { opacity: 1; }
`;

/**
 * @template {keyof HTMLElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Record<string, string>} [attributes]
 * @param {Node[]} children
 */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/**
 * @param {string} name
 * @param {Node} content What is shown if the page puts nothing into the slot.
 */
const slot = (name, content) => make("slot", { name, class: name }, content);

/**
 * @param {ErrorCode | undefined} code
 * @param {string} message
 */
const coded = (code, message) => Object.assign(new Error(message), { code });

/**
 * Returns the URL that a value of a key means on this page.
 * @param {string} key
 * @param {string} value
 */
function resolved(key, value) {
  const isOther = /^(sample|file):/.test(value) || (URLS[key]?.test(value) ?? true);
  return isOther || !URL.canParse(value, document.baseURI) ? value : new URL(value, document.baseURI).href;
}

/**
 * Returns the values that an attribute lists: those of a JSON array, otherwise one.
 * @param {string} text
 * @returns {string[]}
 */
function listed(text) {
  try {
    const list = text.startsWith("[") ? JSON.parse(text) : undefined;
    if (Array.isArray(list)) return list.map(String);
  } catch {
    // A URL may begin with a bracket.
  }
  return [text];
}

/** How long a frame's first message may take after the frame has loaded. */
const PATIENCE_MS = 3000;

/** A frame with the page in it. */
class Frame {
  /** @type {Map<number, { resolve: (result: any) => void, reject: (error: Error) => void }>} */
  #calls = new Map();
  #lastCall = 0;
  #isAlive = false;
  #origin;
  isReady = false;

  /**
   * @param {string} url
   * @param {(event: string, data: any) => void} announce Gets the page's events, and `missing` if there is no such page.
   */
  constructor(url, announce) {
    const { origin } = new URL(url);
    this.#origin = origin === "null" ? "*" : origin;
    this.announce = announce;
    this.element = make("iframe", { part: "frame", src: url, allow: "fullscreen; clipboard-write" });
    /** @type {Promise<void>} Resolves once the page is ready; rejects if it can't start. */
    this.ready = new Promise((resolve, reject) => (this.#calls.set(0, { resolve, reject })));
    this.ready.catch(() => {});
    addEventListener("message", this.#hear);
    // The page sends a message while it loads, which may arrive a little later.
    this.element.addEventListener("load", () => setTimeout(() => {
      if (this.#isAlive || !this.element.isConnected) return;
      announce("missing", {});
      this.#answer(0, { error: "there is no Gaitway", code: "not-found" });
    }, PATIENCE_MS));
  }

  /** @param {MessageEvent} message */
  #hear = ({ source, data }) => {
    if (source !== this.element.contentWindow || data?.gaitway !== 1) return;
    this.#isAlive = true;
    if (data.event === "ready") {
      this.isReady = true;
      this.#answer(0, {});
    } else if (data.event === "failed") this.#answer(0, { error: "Gaitway couldn't start", code: "unsupported" });
    if (data.event === undefined) this.#answer(data.id, data);
    else this.announce(data.event, data);
  };

  /**
   * @param {number} id
   * @param {{ result?: unknown, error?: string, code?: ErrorCode }} answer
   */
  #answer(id, { result, error, code }) {
    const call = this.#calls.get(id);
    this.#calls.delete(id);
    if (error === undefined) call?.resolve(result);
    else call?.reject(coded(code, error));
  }

  /**
   * Calls a function of the page's `window.gaitway`.
   * @param {string} call
   * @param {unknown[]} given
   * @returns {Promise<any>}
   */
  call(call, given) {
    return new Promise((resolve, reject) => {
      const id = ++this.#lastCall;
      this.#calls.set(id, { resolve, reject });
      this.element.contentWindow?.postMessage({ gaitway: 1, id, call, arguments: given }, this.#origin);
    });
  }

  close() {
    removeEventListener("message", this.#hear);
    this.element.remove();
    for (const id of [...this.#calls.keys()]) this.#answer(id, { error: "the viewer was removed, or shows something else", code: "cancelled" });
  }
}

const Base = /** @type {typeof HTMLElement} */ (globalThis.HTMLElement ?? class {});

class Viewer extends Base {
  static observedAttributes = [...Object.keys(KEY_OF), ...OTHERS];
  /**
   * The folder of Gaitway's page, for viewers without the attribute. By default, that around this module's.
   * @type {string}
   */
  static base = "";

  /** @type {Frame | null} */
  #frame = null;
  /** Changed attributes that the frame hasn't received yet. @type {Set<string>} */
  #changed = new Set();
  #isUpdating = false;
  /** The number of pending method calls, which need a frame even if nobody sees it. */
  #calls = 0;
  /** Whether the user has asked for the view. */
  #isRevealed = false;
  #isNear = false;
  /** What went wrong last. */
  #problem = { message: "", code: /** @type {ErrorCode | undefined} */ (undefined) };
  /** Those who wait for a frame. @type {(() => void)[]} */
  #waiting = [];

  #poster = make("img", { part: "poster", alt: "", decoding: "async" });
  #button = make("button", { part: "reveal", type: "button" });
  #bar = make("div", { part: "progress", role: "progressbar", "aria-label": "Loading", "aria-valuemin": "0", "aria-valuemax": "100" }, make("div"));
  #error = make("p", { part: "error", role: "alert" });
  #body = make("div", { class: "waiting" }, slot("poster", this.#poster), this.#button, slot("progress", this.#bar), slot("error", this.#error));
  /** @type {IntersectionObserver | undefined} */
  #observer;

  constructor() {
    super();
    // Not a `<style>` element, which the page's Content-Security-Policy may forbid.
    const style = new CSSStyleSheet();
    style.replaceSync(STYLE);
    const shadow = this.attachShadow({ mode: "open", delegatesFocus: true });
    shadow.adoptedStyleSheets = [style];
    shadow.append(this.#body);
    this.#button.addEventListener("click", () => {
      this.#isRevealed = true;
      this.#start();
    });
  }

  connectedCallback() {
    // Properties that were set before the element was defined would hide those of the class.
    for (const name of Viewer.observedAttributes.map(camelCase)) {
      if (!Object.hasOwn(this, name)) continue;
      const self = /** @type {any} */ (this);
      const value = self[name];
      delete self[name];
      self[name] = value;
    }
    this.#observer = new IntersectionObserver((entries) => {
      this.#isNear = entries.at(-1)?.isIntersecting ?? false;
      this.#start();
    }, { rootMargin: "50%" });
    this.#observer.observe(this);
    this.#updateSoon();
  }

  /** Moved by `moveBefore`, an element keeps its frame. */
  connectedMoveCallback() {}

  disconnectedCallback() {
    this.#observer?.disconnect();
    this.#stop();
  }

  /**
   * @param {string} name
   * @param {string | null} before
   * @param {string | null} now
   */
  attributeChangedCallback(name, before, now) {
    if (before === now) return;
    this.#changed.add(name);
    this.#updateSoon();
  }

  /** Attributes that are set one after the other are one change. */
  #updateSoon() {
    if (this.#isUpdating) return;
    this.#isUpdating = true;
    queueMicrotask(() => {
      this.#isUpdating = false;
      if (this.isConnected) this.#update();
    });
  }

  #update() {
    const changed = this.#changed;
    this.#changed = new Set();
    this.#showTexts();
    const keys = ALL.filter((name) => changed.has(name));
    const isOther = SOURCES.some((name) => changed.has(name));
    if (this.#frame === null) return this.#start();
    // A frame that shows nothing wouldn't load the same model again.
    const startsAgain = isOther && (!this.#hasSources() || this.#body.className === "failed");
    if (startsAgain || OF_FRAME.some((name) => changed.has(name)) || (keys.length > 0 && !this.#frame.isReady)) {
      this.#stop();
      return this.#start();
    }
    // Another model is shown as the attributes say, not as the user left the previous one.
    if (keys.length > 0) this.#show(isOther ? ALL : keys, isOther);
  }

  #showTexts() {
    const [poster, alt] = [this.getAttribute("poster"), this.getAttribute("alt")];
    if (poster === null) this.#poster.removeAttribute("src");
    else if (this.#poster.getAttribute("src") !== poster) this.#poster.src = poster;
    this.#poster.alt = alt ?? "";
    this.#button.hidden = this.getAttribute("reveal") !== "interaction";
    this.#button.setAttribute("aria-label", alt === null ? "Show the 3D view" : `Show the 3D view: ${alt}`);
    if (this.#frame !== null) this.#frame.element.title = alt ?? "3D view";
  }

  #hasSources() {
    return SOURCES.some((name) => this.hasAttribute(name));
  }

  /**
   * Returns the values of attributes by their keys of the link; null for those that are absent.
   * @param {string[]} names
   */
  #values(names = ALL) {
    return Object.fromEntries(names.map((name) => {
      const text = this.getAttribute(name);
      if (name === "controls") return ["embed", text === null ? "viewport" : "transport"];
      const key = KEY_OF[name];
      if (text === null) return [key, null];
      if (FLAGS.includes(name)) return [key, !["0", "false"].includes(text)];
      const values = listed(text).map((value) => resolved(key, value));
      return [key, values.length === 1 ? values[0] : values];
    }));
  }

  /** The address of the page, without a link. */
  #page() {
    const folder = this.getAttribute("base") ?? Viewer.base;
    // In a variable, since bundlers look for a file where `import.meta.url` is an argument of `new URL`.
    const module = import.meta.url;
    const base = folder === "" ? new URL("../", module) : new URL(folder.replace(/\/?$/, "/"), document.baseURI);
    return new URL("index.html", base);
  }

  #link() {
    const pairs = Object.entries(this.#values()).flatMap(([key, value]) => {
      const values = value === null ? [] : [value].flat();
      return values.map((text) => `${key}=${encodeURIComponent(typeof text === "boolean" ? Number(text) : text)}`);
    });
    // The version fixes the defaults of keys that are left out.
    return ["v=2", ...pairs].join("&");
  }

  /** Makes the frame if it is needed by now. */
  #start() {
    if (this.#frame !== null || !this.isConnected) return;
    const isRevealed = this.#isRevealed || this.getAttribute("reveal") !== "interaction";
    const isNear = this.#isNear || this.getAttribute("loading") !== "lazy";
    const isWanted = this.#hasSources() && isRevealed && isNear;
    if (!isWanted && this.#calls === 0) return;
    const page = this.#page();
    if (page.protocol === "file:" && location.protocol !== "file:") {
      return this.#fail("Gaitway's files aren't beside this module: set “base” to the URL of their folder", "not-found");
    }
    page.searchParams.set("viewer", "");
    if (this.hasAttribute("drop")) page.searchParams.set("drop", "");
    const renderer = this.getAttribute("renderer");
    if (renderer) page.searchParams.set("renderer", renderer);
    page.hash = this.#link();
    this.#problem = { message: "", code: undefined };
    const frame = new Frame(page.href, (event, data) => this.#frame === frame && this.#hear(event, data));
    this.#frame = frame;
    this.#setProgress(0);
    this.#setState("loading");
    this.#showTexts();
    this.#body.prepend(frame.element);
    for (const resolve of this.#waiting.splice(0)) resolve();
  }

  #stop() {
    const frame = this.#frame;
    this.#frame = null;
    frame?.close();
    this.#setState("waiting");
  }

  /** @param {"waiting" | "loading" | "shown" | "failed"} state */
  #setState(state) {
    if (state !== "failed") this.#error.textContent = "";
    this.#body.className = state;
  }

  /** @param {number} share */
  #setProgress(share) {
    // Custom bars in the slot inherit it.
    this.#body.style.setProperty("--gaitway-progress", String(share));
    this.#bar.setAttribute("aria-valuenow", String(Math.round(100 * share)));
  }

  /**
   * @param {string} event
   * @param {any} data
   */
  #hear(event, data) {
    if (event === "progress") {
      this.#setProgress(data.progress);
      this.#emit("progress", { progress: data.progress });
    } else if (event === "change") this.#emit("change");
    else if (event === "error") this.#report(data.error, data.code ?? undefined);
    else if (event === "missing") this.#fail(`there is no Gaitway at ${this.#page()}`, "not-found");
    else if (event === "failed" || (event === "ready" && data.isEmpty)) this.#showProblem();
    else if (event === "ready" && this.#hasSources()) this.#reveal();
  }

  /** Shows the frame: the first image of a model is there. */
  #reveal() {
    const hadFocus = this.#body.className === "loading" && (document.activeElement === document.body || document.activeElement === this);
    this.#setState("shown");
    if (this.#isRevealed && hadFocus) this.#frame?.element.focus({ preventScroll: true });
    this.#emit("load");
  }

  /**
   * @param {string} message
   * @param {ErrorCode} [code]
   */
  #report(message, code) {
    this.#problem = { message, code };
    this.#emit("error", this.#problem);
  }

  /**
   * @param {string} message
   * @param {ErrorCode} [code]
   */
  #fail(message, code) {
    this.#report(message, code);
    this.#showProblem();
  }

  #showProblem() {
    this.#error.textContent = this.#problem.message || "This model couldn't be shown.";
    this.#setState("failed");
  }

  /**
   * @param {"progress" | "load" | "change" | "error"} type
   * @param {object} [detail]
   */
  #emit(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  /**
   * Shows the values of these attributes.
   * @param {string[]} names
   * @param {boolean} isOther They name another model or motion.
   */
  async #show(names, isOther) {
    const frame = this.#frame;
    const apply = async (/** @type {object} */ values) => void (await frame?.call("apply", [values]));
    const refuse = (/** @type {Error & { code: ErrorCode }} */ { message, code }) => {
      // A cancelled call is followed by that of what was set since.
      if (frame === this.#frame && code !== "cancelled") this.#report(message, code);
    };
    try {
      await apply(this.#values(names)).catch(async (error) => {
        if (error.code !== "malformed" || names.length === 1) throw error;
        // The frame applies all values or none. One by one, as they are by then, only the malformed ones are refused.
        if (isOther) await apply({ ...BARE, ...this.#values(SOURCES) });
        const rest = isOther ? names.filter((name) => name === "autoplay" || (this.hasAttribute(name) && !SOURCES.includes(name))) : names;
        for (const name of rest) if (frame === this.#frame) await apply(this.#values([name])).catch(refuse);
      });
      if (isOther && frame === this.#frame) this.#reveal();
    } catch (error) {
      refuse(/** @type {Error & { code: ErrorCode }} */ (error));
    }
  }

  /**
   * Calls a function of the page, once there is one.
   * @param {string} call
   * @param {unknown[]} given
   */
  async #call(call, ...given) {
    this.#calls += 1;
    try {
      return await (await this.#readyFrame()).call(call, given);
    } finally {
      this.#calls -= 1;
    }
  }

  /** @returns {Promise<Frame>} */
  async #readyFrame() {
    this.#start();
    const frame = this.#frame;
    try {
      if (frame !== null) await frame.ready;
      else if (this.#body.className === "failed") throw this.#problem;
      else await new Promise((resolve) => this.#waiting.push(() => resolve(undefined)));
    } catch {
      // It may have been replaced by another.
      if (frame === this.#frame) throw coded(this.#problem.code, this.#problem.message);
    }
    return frame?.isReady && frame === this.#frame ? frame : await this.#readyFrame();
  }

  /**
   * @param {Openable | Openable[] | FileList} items
   * @param {{ as?: "motion" }} [options]
   */
  async open(items, options = {}) {
    const list = Array.isArray(items) || items instanceof FileList ? [...items] : [items];
    const opened = await this.#call("open", list.map((item) => (typeof item === "string" || item instanceof URL ? resolved("model", String(item)) : item)), options);
    if (options.as !== "motion") this.#reveal();
    return opened;
  }

  /** @param {Record<string, unknown>} partial */
  apply(partial) {
    const value = (/** @type {string} */ key, /** @type {unknown} */ given) => (typeof given === "string" ? resolved(key, given) : given);
    const values = (/** @type {string} */ key, /** @type {unknown} */ given) => (Array.isArray(given) ? given.map((one) => value(key, one)) : value(key, given));
    return this.#call("apply", Object.fromEntries(Object.entries(partial).map(([key, given]) => [key, values(key, given)])));
  }

  state() {
    return this.#call("state");
  }

  pose() {
    return this.#call("pose");
  }

  screenshot() {
    return this.#call("screenshot");
  }

  play() {
    return this.apply({ play: true });
  }

  pause() {
    return this.apply({ play: false });
  }

  async toLink() {
    if (this.#frame?.isReady) return await this.#call("toLink");
    const link = this.#link().replace(/&embed=\w+/, "");
    return `${this.#page()}#${link}`;
  }
}

for (const attribute of Viewer.observedAttributes) {
  const isBoolean = BOOLEANS.includes(attribute);
  Object.defineProperty(Viewer.prototype, camelCase(attribute), {
    enumerable: true,
    configurable: true,
    /** @this {HTMLElement} */
    get() {
      return isBoolean ? this.hasAttribute(attribute) : this.getAttribute(attribute);
    },
    /**
     * @this {HTMLElement}
     * @param {unknown} value
     */
    set(value) {
      if (value === null || value === undefined || (isBoolean && value === false)) this.removeAttribute(attribute);
      else if (isBoolean) this.setAttribute(attribute, "");
      else this.setAttribute(attribute, Array.isArray(value) ? JSON.stringify(value) : typeof value === "boolean" ? String(Number(value)) : String(value));
    },
  });
}

// Another copy of this module, perhaps of another version, may have come first.
const first = globalThis.customElements?.get("gaitway-viewer");
if (first === undefined) globalThis.customElements?.define("gaitway-viewer", Viewer);

export const GaitwayViewer = /** @type {typeof Viewer} */ (first ?? Viewer);
