// The page as a part of another one: `window.gaitway` by messages. The page around it sends
// `{gaitway: 1, id, call, arguments}` and gets `{gaitway: 1, id, result}` or `{gaitway: 1, id, error}`; events come as
// `{gaitway: 1, event}`. It never gets to know anything of files that a person dropped or chose here.

const READS = ["state", "pose", "stats", "screenshot"];
const WITHHELD = "withheld: the person at this page has opened files of their own; what they show stays here";

/** Set by shell.js before it takes the first file. */
let shell = null;
addEventListener("gaitway:shell", ({ detail }) => (shell = detail), { once: true });

const CALLS = {
  ready: async () => void (await window.gaitway.ready),
  open: (...given) => shell.open(...given),
  apply: (...given) => window.gaitway.apply(...given),
  ...Object.fromEntries(READS.map((call) => [call, () => window.gaitway[call]()])),
};

async function answer(call, given) {
  if (!Object.hasOwn(CALLS, call)) throw new Error(`${call}: there is no such call; there are: ${Object.keys(CALLS).join(", ")}`);
  const [wasPrivate, seen] = [shell.isPrivate(), shell.ownSeen()];
  if (wasPrivate && READS.includes(call)) throw new Error(WITHHELD);
  // A file may have been dropped meanwhile, and gone again.
  const isPrivate = () => wasPrivate || shell.isPrivate() || shell.ownSeen() !== seen;
  let result;
  try {
    result = await CALLS[call](...given);
  } catch (error) {
    // Messages name joints and files.
    throw isPrivate() ? new Error(WITHHELD) : error;
  }
  if (!isPrivate()) return result;
  if (READS.includes(call)) throw new Error(WITHHELD);
  // The document that opening gives lists borrowed clips too.
  return undefined;
}

function tell(event) {
  // There is nothing in it that is not for everyone.
  parent.postMessage({ gaitway: 1, event }, "*");
}

if (parent !== window) {
  addEventListener("message", async ({ data, source, origin }) => {
    if (source !== parent || data?.gaitway !== 1 || typeof data.call !== "string") return;
    // A page without an origin (a sandbox) cannot be named.
    const reply = (part) => source.postMessage({ gaitway: 1, id: data.id, ...part }, { targetOrigin: origin === "null" ? "*" : origin });
    try {
      reply({ result: await answer(data.call, Array.isArray(data.arguments) ? data.arguments : []) });
    } catch (error) {
      reply({ error: error.message });
    }
  });
  addEventListener("gaitway:change", () => tell("change"));
  addEventListener("gaitway:shell", () => window.gaitway.ready.then(() => tell("ready"), () => tell("failed")), { once: true });
}
