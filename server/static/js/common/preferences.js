// Language and colours of the page: kept in cookies, so that the server writes the page that way.

const YEAR = 365 * 24 * 3600; // s

function keep(name, value) {
  document.cookie = `${name}=${value}; path=/; max-age=${value ? YEAR : 0}; samesite=lax`;
}

/** Wire the selects of templates/preferences.html, on pages that have them. */
export function connectPreferences() {
  const language = document.getElementById("language");
  const theme = document.getElementById("theme");
  language?.addEventListener("change", () => {
    keep("laserbot_language", language.value);
    location.reload(); // the server writes the page in it
  });
  theme?.addEventListener("change", () => {
    keep("laserbot_theme", theme.value);
    if (theme.value) document.documentElement.dataset.theme = theme.value;
    else delete document.documentElement.dataset.theme;
  });
}
