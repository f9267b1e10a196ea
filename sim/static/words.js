// The words of the arena's own page, in the browser's language. A page around the arena brings its own for the picture.

const WORDS = {
  en: {
    you: "YOU", hit: "HIT", empty: "No robot on the floor yet",
    arena: "Arena", robots: "Robots", life: "life", robot: "Robot {n}", picture: "The arena seen from above",
    connecting: "connecting", live: "live", lost: "the arena does not answer, trying again", out: "out", waiting: "not ready",
  },
  it: {
    you: "TU", hit: "COLPITO", empty: "Ancora nessun robot in campo",
    arena: "Arena", robots: "Robot", life: "vita", robot: "Robot {n}", picture: "L’arena vista dall’alto",
    connecting: "collegamento", live: "in diretta", lost: "l’arena non risponde, nuovo tentativo", out: "fuori", waiting: "non pronto",
  },
  de: {
    you: "DU", hit: "TREFFER", empty: "Noch kein Roboter in der Arena",
    arena: "Arena", robots: "Roboter", life: "Leben", robot: "Roboter {n}", picture: "Die Arena von oben",
    connecting: "verbinde", live: "live", lost: "die Arena antwortet nicht, neuer Versuch", out: "draußen", waiting: "nicht bereit",
  },
};

/** The first of `languages` (BCP 47, the reader's favourite first) that there is, else English. */
export function languageOf(languages) {
  return languages.map((tag) => tag.toLowerCase().split("-")[0]).find((tag) => tag in WORDS) ?? "en";
}

/** All words of one of the languages. */
export const wordsOf = (language) => WORDS[language];
