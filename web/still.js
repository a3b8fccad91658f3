// The picture that is seen while the page loads: that of the scene that is asked for. It runs before anything is shown, so
// that nobody sees another scene's first, and has the scene's samples on their way while the program still is.

(() => {
  const still = document.getElementById("loading-still");
  /** By the models of a scene's link. */
  const pictures = JSON.parse(still.dataset.pictures);
  const modelsOf = (link) => link.split("&").filter((pair) => pair.startsWith("model=")).join("&");

  function show(link, isLocal) {
    const picture = isLocal ? undefined : link === "" ? still.getAttribute("src") : pictures[modelsOf(link)];
    still.hidden = picture === undefined;
    if (!still.hidden && still.getAttribute("src") !== picture) still.src = picture;
  }

  function fetchAhead(link) {
    const samples = JSON.parse(document.querySelector('meta[name="gaitway-samples"]').content);
    for (const [, name] of link.matchAll(/(?:^|&)(?:model|motion)=sample:(\w+)/g)) {
      const links = (samples[name] ?? []).map((href) => Object.assign(document.createElement("link"), { rel: "preload", as: "fetch", crossOrigin: "", href }));
      document.head.append(...links);
    }
  }

  const asked = location.hash.slice(1);
  show(asked, false);
  fetchAhead(asked || still.dataset.link);
  addEventListener("gaitway:loading", ({ detail: { link, isLocal } }) => show(link, isLocal));
})();
