// What the page says, in the language that the server has chosen: the sections that this page uses come with it.

let words = {};
let locale = "en";

/**
 * Take the words and the language of a page.
 * @param {object} sections {section: {key: text}}; a text is a string or, by number, {one, other}
 * @param {string} language BCP 47, such as "de"
 */
export function setWords(sections, language) {
  words = sections;
  locale = language;
}

/**
 * The text with this key, "section.key", in the page's language. `values` fill its {places}; numbers are written as
 * the language writes them, and the value `n` chooses between one and many.
 */
export function t(key, values = {}) {
  const found = key.split(".").reduce((level, part) => level?.[part], words);
  if (found === undefined) throw new Error(`no words for ${key}`);
  const text = typeof found === "string" ? found : found[new Intl.PluralRules(locale).select(values.n)] ?? found.other;
  return text.replace(/\{(\w+)\}/g, (_, name) => (typeof values[name] === "number" ? number(values[name]) : values[name]));
}

export const number = (value, options) => new Intl.NumberFormat(locale, options).format(value);
export const percent = (value) => number(value / 100, { style: "percent" });

/** A moment as day and time; `options` as Intl has them. */
export const dateTime = (date, options = { dateStyle: "medium", timeStyle: "short" }) =>
  new Intl.DateTimeFormat(locale, options).format(date);

/** Names in the order of the language, "Al, Bo and Cy". */
export const list = (names) => new Intl.ListFormat(locale).format(names);

const embedded = globalThis.document?.getElementById("words");
if (embedded) setWords(JSON.parse(embedded.textContent), document.documentElement.lang);
