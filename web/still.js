// Runs before anything is shown: picks the image that covers the page while it loads, and starts downloading the
// samples of the link side by side with the program, and its models from part of the way on: they may be large. There
// is no program yet that could read the link, and this script doesn't read it either: it searches its text for names
// that are worth having early. crates/scene/tests/scene/early.json holds what it finds against the files that the program finds.

(() => {
  const still = /** @type {HTMLImageElement} */ (document.getElementById("loading-still"));
  /**
   * Images by the model they show.
   * @type {Record<string, string>}
   */
  const images = JSON.parse(still.dataset.images ?? "{}");
  /** The element around the frame has a poster of its own; see shell/viewer.js. */
  const isViewer = parent !== window && new URLSearchParams(location.search).has("viewer");
  /** A link may name any number of models; the program holds this many at once (`Library::MAX_MODELS`). */
  const MAX_PRELOADED = 8;
  /** The link of the first screen. */
  const first = still.dataset.link ?? "";

  /**
   * A percent sign that escapes nothing is taken literally.
   * @param {string} text
   */
  function decoded(text) {
    try {
      return decodeURIComponent(text);
    } catch {
      return text;
    }
  }

  /** @param {string} link */
  const modelsOf = (link) => Array.from(link.matchAll(/\bmodel=([^&]+)/g), ([, model]) => decoded(model));

  /**
   * @param {string} link
   * @param {boolean} isLocal
   */
  function show(link, isLocal) {
    const models = isLocal || isViewer ? [] : modelsOf(link || first).filter((model) => Object.hasOwn(images, model));
    still.hidden = models.length !== 1;
    if (!still.hidden && still.getAttribute("src") !== images[models[0]]) still.src = images[models[0]];
  }

  /** @param {string} link */
  function preloadSamples(link) {
    const meta = /** @type {HTMLMetaElement | null} */ (document.querySelector('meta[name="gaitway-samples"]'));
    /** @type {Record<string, string[]>} */
    const samples = JSON.parse(meta?.content ?? "{}");
    const names = new Set(Array.from(decoded(link).matchAll(/sample:(\w+)/g), ([, name]) => name));
    preload(Object.keys(samples).filter((name) => names.has(name)).flatMap((name) => samples[name]));
  }

  /** @param {string} link */
  function preloadModels(link) {
    preload(modelsOf(link).filter((model) => /^https?:/.test(model) && URL.canParse(model)).slice(0, MAX_PRELOADED));
  }

  /** @param {string[]} files */
  function preload(files) {
    document.head.append(...files.map((href) => Object.assign(document.createElement("link"), { rel: "preload", as: "fetch", crossOrigin: "", href })));
  }

  const asked = location.hash.slice(1);
  show(asked, false);
  preloadSamples(asked || first);
  addEventListener("gaitway:part-loaded", () => preloadModels(asked), { once: true });
  addEventListener("gaitway:loading", ({ detail: { link, isLocal } }) => show(link, isLocal));
})();
