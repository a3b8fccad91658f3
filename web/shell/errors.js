// Errors that `window.gaitway` rejects with: the message for people, and a code for scripts. Most come from the program
// (src/files/error.rs), some from the shell.

/** @typedef {import("./types.d.ts").ErrorCode} ErrorCode */
/** @typedef {import("./types.d.ts").GaitwayError} GaitwayError */

/**
 * @param {ErrorCode} code
 * @param {string} message
 * @returns {GaitwayError}
 */
export const coded = (code, message) => Object.assign(new Error(message), { code });

/**
 * Returns an error's code, if it has one.
 * @param {unknown} error
 * @returns {ErrorCode | undefined}
 */
export const codeOf = (error) => (error instanceof Error && "code" in error ? /** @type {GaitwayError} */ (error).code : undefined);
