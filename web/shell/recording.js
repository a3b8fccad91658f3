// Files for the user to keep: downloads, and videos of the canvas.
import { canvas } from "./dom.js";

const TYPES = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];
const BITS_PER_SECOND = 12_000_000;
/** Time for the browser to start reading a download. */
const DOWNLOAD_TIMEOUT_MS = 10_000;

/** @type {MediaRecorder | null} */
let recorder = null;

/** Starts recording the canvas; returns false if the browser can't. */
export function startRecording() {
  const mimeType = typeof MediaRecorder === "undefined" ? undefined : TYPES.find((type) => MediaRecorder.isTypeSupported(type));
  const stream = mimeType === undefined ? undefined : canvas()?.captureStream?.();
  if (stream === undefined) return false;
  try {
    recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: BITS_PER_SECOND });
    recorder.start();
  } catch {
    recorder = null;
  }
  return recorder !== null;
}

/**
 * Ends the recording and saves it; without a name it is discarded.
 * @param {string} [name]
 */
export function stopRecording(name) {
  const ended = recorder;
  recorder = null;
  if (ended === null) return;
  /** @type {Blob[]} */
  const parts = [];
  ended.ondataavailable = ({ data }) => parts.push(data);
  ended.onstop = () => {
    ended.stream.getTracks().forEach((track) => track.stop());
    if (name !== undefined && name !== null) download(name, new Blob(parts));
  };
  ended.stop();
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
