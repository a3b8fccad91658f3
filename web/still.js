// Runs before anything is shown: picks the image that covers the page while it loads, and starts downloading the samples of
// the link side by side with the program, and its models from part of the way on: they may be large. There is no program to
// ask yet, so this is the one script that reads links itself, by the rules of src/state/link.rs. It only guesses what is worth
// having early; what the page shows is for the program to read.

(() => {
  const still = /** @type {HTMLImageElement} */ (document.getElementById("loading-still"));
  /**
   * Images by the model they show.
   * @type {Record<string, string>}
   */
  const images = JSON.parse(still.dataset.images ?? "{}");
  /** The link of the first screen. */
  const first = still.dataset.link ?? "";

  /**
   * Decodes as the program does: a plus sign stays one, and so does a percent sign that escapes nothing.
   * @param {string} text
   */
  function decoded(text) {
    try {
      return decodeURIComponent(text);
    } catch {
      return text;
    }
  }

  /**
   * @param {string} link
   * @returns {{ key: string, value: string }[]}
   */
  const pairs = (link) =>
    link.split("&").map((pair) => {
      const [key, ...value] = pair.split("=");
      return { key: decoded(key), value: decoded(value.join("=")) };
    });

  /** @param {string} link */
  const modelsOf = (link) => pairs(link).flatMap(({ key, value }) => (key === "model" ? [value] : []));

  /**
   * @param {string} link
   * @param {boolean} isLocal
   */
  function show(link, isLocal) {
    const models = isLocal ? [] : modelsOf(link || first).filter((model) => Object.hasOwn(images, model));
    still.hidden = models.length !== 1;
    if (!still.hidden && still.getAttribute("src") !== images[models[0]]) still.src = images[models[0]];
  }

  /** @param {string} link */
  function preloadSamples(link) {
    const meta = /** @type {HTMLMetaElement | null} */ (document.querySelector('meta[name="gaitway-samples"]'));
    /** @type {Record<string, string[]>} */
    const samples = JSON.parse(meta?.content ?? "{}");
    const values = new Set(pairs(link).map(({ value }) => value));
    preload(Object.keys(samples).filter((name) => values.has(`sample:${name}`)).flatMap((name) => samples[name]));
  }

  /** @param {string} link */
  function preloadModels(link) {
    preload(modelsOf(link).filter((model) => /^https?:/.test(model) && URL.canParse(model)));
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
