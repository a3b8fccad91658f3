// URLs in a text that comes from outside the page.

/**
 * Returns the URLs that a text consists of, one a line; none if it says anything else. The part of this page's URL from the `#` on
 * stands for all of it.
 * @param {string} text
 */
export function urlsIn(text) {
  const lines = text.split(/[\r\n]+/).map((line) => line.trim()).filter((line) => line !== "" && !line.startsWith("# "));
  const urls = lines.map((line) => (/^#?v=\d+(&|$)/.test(line) ? linkTo(line.replace("#", "")) : line));
  return urls.every((url) => /^https?:\/\//i.test(url) && URL.canParse(url)) ? urls : [];
}

/** @param {string} link */
const linkTo = (link) => `${location.origin}${location.pathname}#${link}`;

/**
 * Returns the first URL within a text, as other apps share one with a title.
 * @param {string} text
 */
export const urlWithin = (text) => text.match(/https?:\/\/\S+/gi)?.find((url) => URL.canParse(url));
