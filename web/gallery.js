// The samples under the picture: cards that are nothing but links. On the first screen they are there by themselves; with a
// link, in a frame and once somebody has opened files of their own they are not, and come back when asked for.

const byId = (id) => document.getElementById(id);
const gallery = byId("gallery");
const cards = [...gallery.querySelectorAll("a.card")];

const pairsOf = (link) => link.split("&");
/** What a link shows, whatever the view of it is. */
const filesOf = (link) => pairsOf(link).filter((pair) => /^(model|motion)=/.test(pair)).sort().join("&");

function show(shown) {
  if (gallery.hidden !== shown) return;
  const hadFocus = gallery.contains(document.activeElement);
  gallery.hidden = !shown;
  if (hadFocus && !shown) toCanvas();
}

const toCanvas = () => byId("stage").querySelector("canvas")?.focus({ preventScroll: true });

/** Marks the card of what is shown, of several with the same files the nearest; none when it is something else. */
function mark(link) {
  const pairs = pairsOf(link);
  const alike = ({ hash }) => pairsOf(hash.slice(1)).filter((pair) => pairs.includes(pair)).length;
  const same = cards.filter(({ hash }) => filesOf(hash.slice(1)) === filesOf(link));
  const shown = same.sort((a, b) => alike(b) - alike(a))[0];
  for (const card of cards) card.setAttribute("aria-current", card === shown);
}

show(location.hash.length < 2 && parent === window && cards.length > 0);

addEventListener("gaitway:shown", ({ detail: { link, isLocal } }) => {
  if (isLocal) show(false);
  mark(link);
});

addEventListener("gaitway:samples", () => {
  show(true);
  (cards.find((card) => card.ariaCurrent === "true") ?? gallery.querySelector(".card")).focus();
});

byId("gallery-close").addEventListener("click", () => show(false));
byId("do-samples").addEventListener("click", () => dispatchEvent(new CustomEvent("gaitway:samples")));
byId("gallery-own").addEventListener("click", () => byId("do-open").click());
// In the picture the key is for what is chosen there.
addEventListener("keydown", ({ key, target }) => key === "Escape" && (target === document.body || gallery.contains(target)) && show(false));
// Who clicks wants to play with it: the keys go to the picture. Who came by keyboard goes on from here.
for (const card of cards) card.addEventListener("click", ({ detail, ctrlKey, metaKey, shiftKey }) => detail > 0 && !(ctrlKey || metaKey || shiftKey) && toCanvas());
