// Runs before anything is shown: picks the image that covers the page while it loads, and starts downloading the samples of
// the link side by side with the program, and its models from part of the way on: they may be large. It only guesses what is
// worth having early; the program reads the link.

(() => {
  const still = /** @type {HTMLImageElement} */ (document.getElementById("loading-still"));
  /**
   * Images by the model they show.
   * @type {Record<string, string>}
   */
  const images = JSON.parse(still.dataset.images ?? "{}");
  /** The link of the first screen. */
  const first = still.dataset.link ?? "";

  /** @type {(link: string, text: string) => boolean} */
  const has = (link, text) => `&${link}&`.includes(`${text}&`);

  /**
   * @param {string} link
   * @param {boolean} isLocal
   */
  function show(link, isLocal) {
    const models = isLocal ? [] : Object.keys(images).filter((model) => has(link || first, `&model=${model}`));
    still.hidden = models.length !== 1;
    if (!still.hidden && still.getAttribute("src") !== images[models[0]]) still.src = images[models[0]];
  }

  /** @param {string} link */
  function preloadSamples(link) {
    const meta = /** @type {HTMLMetaElement | null} */ (document.querySelector('meta[name="gaitway-samples"]'));
    /** @type {Record<string, string[]>} */
    const samples = JSON.parse(meta?.content ?? "{}");
    const names = Object.keys(samples).filter((name) => has(link, `=sample:${name}`));
    preload(names.flatMap((name) => samples[name]));
  }

  /** @param {string} link */
  function preloadModels(link) {
    preload(new URLSearchParams(link).getAll("model").filter((model) => /^https?:/.test(model) && URL.canParse(model)));
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
