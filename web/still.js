// The picture that is seen while the page loads: that of the scene that is asked for. It runs before anything is shown, so
// that nobody sees another scene's first.

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

  show(location.hash.slice(1), false);
  addEventListener("gaitway:loading", ({ detail: { link, isLocal } }) => show(link, isLocal));
})();
