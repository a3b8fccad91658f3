// Serves a folder until the process is stopped: `node xtask/site/serve.mjs FOLDER PORT`. Port 0 chooses a free port.
import { serve } from "./server.mjs";

const [folder, port] = process.argv.slice(2);
try {
  const { origin } = await serve({ "/": folder }, { "cache-control": "no-cache" }, Number(port));
  console.log(`Gaitway is running at ${origin}/ (press Ctrl+C to stop)`);
  // The server alone doesn't keep the process alive.
  setInterval(() => {}, 2 ** 31 - 1);
} catch (error) {
  if (/** @type {NodeJS.ErrnoException} */ (error).code !== "EADDRINUSE") throw error;
  console.error(`error: port ${port} is in use; choose another one with --port`);
  process.exitCode = 1;
}
