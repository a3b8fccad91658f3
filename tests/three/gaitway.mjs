// Runs the command line for the tests.
import { execFile } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import { targetFolder } from "./data.mjs";

/** The binary: GAITWAY_CLI, or whatever cargo built last. */
export const program = (() => {
  if (process.env.GAITWAY_CLI) return process.env.GAITWAY_CLI;
  const name = process.platform === "win32" ? "gaitway.exe" : "gaitway";
  const built = ["release", "debug"].map((profile) => path.join(targetFolder, profile, name)).filter((file) => fs.existsSync(file));
  if (built.length === 0) throw new Error("no gaitway binary: run `cargo build`, or set GAITWAY_CLI");
  return built.sort((a, b) => fs.statSync(b).mtimeMs - fs.statSync(a).mtimeMs)[0];
})();

/**
 * Runs `gaitway …`, whatever the outcome.
 * @param {...string} args
 * @returns {Promise<{ status: number | string, stdout: string, stderr: string }>}
 */
export function run(...args) {
  return new Promise((resolve) => {
    execFile(program, args, { maxBuffer: 1 << 28, timeout: 60_000 }, (error, stdout, stderr) => {
      resolve({ status: error === null ? 0 : (error.code ?? error.signal ?? "unknown"), stdout, stderr });
    });
  });
}

/**
 * Returns the document that `gaitway … --json` prints, or throws the program's error.
 * @param {...string} args
 */
export async function document(...args) {
  const { status, stdout, stderr } = await run(...args, "--json");
  if (status !== 0) throw new Error(`gaitway ${args.join(" ")}: status ${status}: ${stderr.trim()}`);
  return JSON.parse(stdout);
}
