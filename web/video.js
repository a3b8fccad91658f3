// Encodes a video or GIF frame by frame, however long each takes to draw, or an archive with an image of each. A part of the page
// that is downloaded when it is first used. Uses WebCodecs, and MediaRecorder where that is missing.
//! Contains Mediabunny (MPL-2.0), unmodified; its source code: https://github.com/Vanilagy/mediabunny
//! Contains fflate (MIT), Copyright (c) 2023 Arjun Barrett
import { Zip, ZipPassThrough } from "fflate";
import { BufferTarget, Mp4OutputFormat, Output, Quality, VideoSample, VideoSampleSource, WebMOutputFormat, getFirstEncodableVideoCodec } from "mediabunny";
import { animatedGif } from "./gif.js";

/**
 * @typedef {object} Video
 * @property {number} width Even.
 * @property {number} height Even.
 * @property {number} framesPerSec
 * @property {number} frameCount
 * @property {boolean} isTransparent
 * @property {"video" | "gif" | "images"} format Images are PNGs in an archive.
 * @property {(index: number) => Promise<Uint8Array<ArrayBuffer>>} frame Returns RGBA rows from the top, with straight
 *   alpha.
 * @property {AbortSignal} signal
 */

/** @typedef {{ blob: Blob, extension: "mp4" | "webm" | "gif" | "zip" }} EncodedVideo */

/** @typedef {import("mediabunny").VideoCodec} Codec */

/**
 * Nearly everything plays the first.
 * @type {Codec[]}
 */
const CODECS = ["avc", "vp9", "av1", "vp8"];
/**
 * Those that can be transparent in WebM.
 * @type {Codec[]}
 */
const ALPHA_CODECS = ["vp9", "vp8"];
const RECORDER_TYPES = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];

/**
 * The library's “high” quality as quantizers, with which an encoder takes the bits that it needs. Not every one has them.
 * @type {Partial<Record<Codec, number>>}
 */
const QUANTIZERS = { avc: 22, vp9: 28, av1: 112 };
const BITS_PER_PIXEL = 0.1;
/** Smaller videos need more bits per pixel: each shows more of the character. */
const ENOUGH_PIXELS = 1920 * 1080;

/**
 * Returns the bit rate for encoders without quantizers.
 * @param {Video} video
 */
const bitsPerSec = ({ width, height, framesPerSec }) => Math.ceil(BITS_PER_PIXEL * Math.max(1, Math.cbrt(ENOUGH_PIXELS / (width * height))) * width * height * framesPerSec);

/**
 * Rejects if the browser can't encode the whole video, and when it is cancelled.
 * @param {Video} video
 * @returns {Promise<EncodedVideo>}
 */
export async function encode(video) {
  if (video.format === "images") return encodeImages(video);
  if (video.format === "gif") return encodeGif(video);
  const { width, height, isTransparent } = video;
  const canEncode = typeof VideoEncoder !== "undefined";
  const quality = new Quality({ bitrate: bitsPerSec(video) });
  const codec = canEncode ? await getFirstEncodableVideoCodec(isTransparent ? ALPHA_CODECS : CODECS, { width, height, quality }) : null;
  if (codec !== null) return encodeFrames(video, codec);
  if (isTransparent) throw new Error("this browser can't encode transparent ones. Use Chrome or Edge, or choose a background.");
  return recordFrames(video);
}

/**
 * @param {Video} video
 * @param {Codec} codec
 * @returns {Promise<EncodedVideo>}
 */
async function encodeFrames(video, codec) {
  const { width, height, framesPerSec, frameCount, isTransparent } = video;
  const quality = new Quality({ bitrate: bitsPerSec(video), quantizer: QUANTIZERS[codec] });
  const isMp4 = codec === "avc";
  const target = new BufferTarget();
  const output = new Output({ format: isMp4 ? new Mp4OutputFormat() : new WebMOutputFormat(), target });
  let encodedCount = 0;
  const source = new VideoSampleSource({ codec, quality, alpha: isTransparent ? "keep" : "discard", onEncodedPacket: () => (encodedCount += 1) });
  output.addVideoTrack(source, { frameRate: framesPerSec });
  try {
    await output.start();
    for (let index = 0; index < frameCount; index++) {
      const data = await nextFrame(video, index);
      const sample = new VideoSample(data, { format: isTransparent ? "RGBA" : "RGBX", codedWidth: width, codedHeight: height, timestamp: index / framesPerSec, duration: 1 / framesPerSec });
      // Resolves when the encoder can take another, so that few frames are in memory.
      await source.add(sample);
      sample.close();
    }
    await output.finalize();
  } catch (error) {
    await output.cancel();
    throw error;
  }
  if (encodedCount !== frameCount || target.buffer === null) throw new Error(`the browser encoded ${encodedCount} of ${frameCount} frames`);
  return { blob: new Blob([target.buffer]), extension: isMp4 ? "mp4" : "webm" };
}

/**
 * @param {Video} video
 * @returns {Promise<EncodedVideo>}
 */
async function encodeImages(video) {
  const { width, height, frameCount } = video;
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (context === null) throw new Error("this browser can't encode images of this size.");
  const digits = String(frameCount).length;
  /** @type {Uint8Array<ArrayBuffer>[]} */
  const chunks = [];
  const zip = new Zip((error, chunk) => {
    if (error !== null) throw error;
    chunks.push(/** @type {Uint8Array<ArrayBuffer>} */ (chunk));
  });
  for (let index = 0; index < frameCount; index++) {
    const data = await nextFrame(video, index);
    context.putImageData(new ImageData(new Uint8ClampedArray(data.buffer), width, height), 0, 0);
    const png = await canvas.convertToBlob({ type: "image/png" });
    // Stored as they are, since PNGs are compressed.
    const file = new ZipPassThrough(`frame-${String(index + 1).padStart(digits, "0")}.png`);
    zip.add(file);
    file.push(new Uint8Array(await png.arrayBuffer()), true);
  }
  zip.end();
  return { blob: new Blob(chunks), extension: "zip" };
}

/**
 * @param {Video} video
 * @returns {Promise<EncodedVideo>}
 */
async function encodeGif(video) {
  const gif = animatedGif(video);
  for (let index = 0; index < video.frameCount; index++) gif.add(await nextFrame(video, index));
  return { blob: new Blob([gif.finish()]), extension: "gif" };
}

/**
 * @param {Video} video
 * @param {number} index
 */
async function nextFrame({ frame, signal }, index) {
  signal.throwIfAborted();
  const data = await frame(index);
  signal.throwIfAborted();
  return data;
}

/**
 * Records in real time with MediaRecorder, which pauses while a frame is drawn.
 * @param {Video} video
 * @returns {Promise<EncodedVideo>}
 */
async function recordFrames(video) {
  const { width, height, framesPerSec, frameCount } = video;
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  // In memory: from the graphics device, frames would arrive while the recorder is paused.
  const context = canvas.getContext("2d", { willReadFrequently: true });
  const mimeType = typeof MediaRecorder === "undefined" ? undefined : RECORDER_TYPES.find((type) => MediaRecorder.isTypeSupported(type));
  const stream = mimeType === undefined ? undefined : canvas.captureStream?.(0);
  if (context === null || mimeType === undefined || stream === undefined) throw new Error("this browser can't encode any. Use a current version of Chrome, Edge, Firefox or Safari, or save images instead.");
  const track = /** @type {CanvasCaptureMediaStreamTrack} */ (stream.getVideoTracks()[0]);
  const recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: bitsPerSec(video) });
  /** @type {Blob[]} */
  const chunks = [];
  recorder.ondataavailable = ({ data }) => chunks.push(data);
  const stopped = new Promise((resolve, reject) => {
    recorder.onstop = resolve;
    recorder.onerror = () => reject(new Error("the browser stopped encoding"));
  });
  stopped.catch(() => {});
  try {
    recorder.start();
    recorder.pause();
    for (let index = 0; index < frameCount; index++) {
      const data = await nextFrame(video, index);
      recorder.resume();
      // Captures what is drawn next.
      track.requestFrame();
      context.putImageData(new ImageData(new Uint8ClampedArray(data.buffer), width, height), 0, 0);
      await Promise.race([new Promise((done) => setTimeout(done, 1000 / framesPerSec)), stopped]);
      recorder.pause();
    }
  } finally {
    if (recorder.state !== "inactive") recorder.stop();
    track.stop();
  }
  await stopped;
  const blob = new Blob(chunks, { type: mimeType });
  await assertPlayable(blob);
  return { blob, extension: mimeType.startsWith("video/mp4") ? "mp4" : "webm" };
}

/**
 * A recorder that received no frame in time writes a file without any.
 * @param {Blob} blob
 */
async function assertPlayable(blob) {
  const player = document.createElement("video");
  player.src = URL.createObjectURL(blob);
  try {
    await new Promise((resolve, reject) => {
      player.onloadeddata = resolve;
      player.onerror = () => reject(new Error("the browser encoded no frames"));
    });
  } finally {
    URL.revokeObjectURL(player.src);
  }
}
