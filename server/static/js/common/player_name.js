// What a player may be called. Pure.

const MAX_NAME = 16; // characters

/** A name as it is meant: a space too many is soon typed, on phones by the keyboard itself. */
export const tidyName = (typed) => typed.trim().replace(/\s+/gu, " ").normalize("NFC");

/** What the server takes as a name: 1 to 16 letters, digits (of any script), underscores and single spaces between them. */
export function isValidName(name) {
  const isMadeOfWords = /^[\p{L}\p{N}_][\p{L}\p{N}\p{M}_]*( [\p{L}\p{N}_][\p{L}\p{N}\p{M}_]*)*$/u.test(name);
  return isMadeOfWords && [...name].length <= MAX_NAME && !/\p{Default_Ignorable_Code_Point}/u.test(name);
}
