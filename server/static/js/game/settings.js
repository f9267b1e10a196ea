// Where a player chooses how to play: two buttons on the page, and a form with all the preferences.

import { element } from "../common/dom.js";
import { connectFullscreen } from "../common/screen.js";
import { t } from "../common/words.js";

/**
 * The buttons for sound and for the whole screen. They are pressed while it is on; css/touch.css shows of a button.switch
 * the .icon-on then, else the .icon-off.
 * @param {{sound: HTMLElement, fullscreen: HTMLElement}} buttons
 * @param {import("../common/preferences_store.js").Preferences} preferences
 */
export function connectSwitches({ sound, fullscreen }, preferences) {
  name(sound, t("sounds.sound"));
  const show = () => sound.setAttribute("aria-pressed", String(preferences.get("sound")));
  sound.addEventListener("click", () => preferences.toggle("sound"));
  preferences.watch(show);
  show();
  name(fullscreen, t("controls.fullscreen"));
  connectFullscreen(fullscreen);
}

function name(button, text) {
  button.title = text;
  button.ariaLabel = text;
}

/**
 * All preferences as labelled fields that take effect and are kept at once.
 * @param {import("../common/preferences_store.js").Preferences} preferences
 * @param {import("../common/speaker.js").Speaker} speaker lets a new volume be heard
 */
export function settingsForm(preferences, speaker) {
  const volume = element("input", { type: "range", min: 0, max: 1, step: 0.1 });
  volume.addEventListener("change", () => {
    preferences.set("volume", Number(volume.value));
    speaker.play("last");
  });
  const touch = element(
    "select",
    {},
    ...["pad", "stick"].map((kind) => element("option", { value: kind }, t(`controls.touch_${kind}`))),
  );
  touch.addEventListener("change", () => preferences.set("touch", touch.value));
  const sound = tickBox(preferences, "sound");
  const hints = tickBox(preferences, "hints");
  const guide = tickBox(preferences, "guide");
  const show = () => {
    volume.value = preferences.get("volume");
    touch.value = preferences.get("touch");
    sound.checked = preferences.get("sound");
    hints.checked = preferences.get("hints");
    guide.checked = preferences.get("guide");
  };
  preferences.watch(show);
  show();
  return element(
    "div",
    { className: "preferences" },
    element("label", {}, t("sounds.sound"), sound),
    element("label", {}, t("sounds.volume"), volume),
    element("label", {}, t("controls.touch"), touch),
    element("label", {}, t("controls.hints"), hints),
    element("label", {}, t("controls.guide"), guide),
  );
}

function tickBox(preferences, name) {
  const box = element("input", { type: "checkbox" });
  box.addEventListener("change", () => preferences.set(name, box.checked));
  return box;
}
