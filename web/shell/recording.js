// Files for the user to keep: downloads, and recordings, which a downloaded part encodes.
import { messageOf } from "./dom.js";
import { importScript } from "./parts.js";

/** Time for the browser to start reading a download. */
const DOWNLOAD_TIMEOUT_MS = 10_000;

/** Ends the recording that is under way. */
let recording = new AbortController();

export const cancelRecording = () => recording.abort();

/**
 * Records a video, a GIF or images, and downloads the file. Resolves to its file name; to nothing if cancelled.
 * @param {string} name
 * @param {Omit<import("../video.js").Video, "signal">} video
 */
export async function record(name, video) {
  cancelRecording();
  const { signal } = (recording = new AbortController());
  /** @type {Promise<undefined>} */
  const cancelled = new Promise((resolve) => signal.addEventListener("abort", () => resolve(undefined)));
  // Whatever hangs can be cancelled.
  const encoded = await Promise.race([encode({ ...video, signal }), cancelled]);
  if (encoded === undefined || signal.aborted) return undefined;
  const file = `${name}.${encoded.extension}`;
  download(file, encoded.blob);
  return file;
}

/** @param {import("../video.js").Video} video */
async function encode(video) {
  /** @type {typeof import("../video.js")} */
  let part;
  try {
    part = await importScript("video");
  } catch (error) {
    throw new Error(`the encoder can't be loaded. Check the connection and try again. (${messageOf(error)})`, { cause: error });
  }
  return part.encode(video);
}

/**
 * @param {string} name
 * @param {Blob | Uint8Array<ArrayBuffer>} content
 */
export function download(name, content) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], { type: "application/octet-stream" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), DOWNLOAD_TIMEOUT_MS);
}
