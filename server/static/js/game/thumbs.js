// The controls for thumbs on the game page: pad or floating stick for the left one, the fire button for the right one.

import { element, icon } from "../common/dom.js";
import { connectFire, connectPad, connectStick } from "../drive/touch.js";
import { t } from "../common/words.js";

const DIRECTIONS = ["up", "right", "down", "left"];

/**
 * Fill `box`, which lies over the stage or below it, and connect it with `driver`. css/touch.css has the looks; elements with
 * data-action are lit up by whoever shows what is held; a .charge-fill fills after a shot.
 * @param {HTMLElement} box
 * @param {import("../drive/driver.js").Driver} driver
 * @param {import("../common/preferences_store.js").Preferences} preferences
 * @param {() => void} onChange is called after each change of what is held
 */
export function connectThumbs(box, driver, preferences, onChange) {
  const pad = element("div", { className: "thumb-pad", role: "group", ariaLabel: t("controls.pad") }, ...DIRECTIONS.map(arrow));
  const stick = element("div", { className: "thumb-stick" }, element("i"));
  const zone = element("div", { className: "thumb-zone", role: "group", ariaLabel: t("controls.stick") }, stick);
  const fire = element(
    "button",
    { type: "button", className: "thumb-fire", tabIndex: -1 },
    element("span", {}, t("controls.fire")),
    element("i", {}, element("b", { className: "charge-fill" })),
  );
  fire.dataset.action = "shoot";
  connectPad(pad, driver, onChange);
  connectStick(zone, stick, driver, onChange);
  connectFire(fire, driver, onChange);

  const show = () => {
    const isStick = preferences.get("touch") === "stick";
    pad.hidden = isStick;
    zone.hidden = !isStick;
  };
  preferences.watch((name) => {
    if (name !== "touch") return;
    driver.releaseAll(); // what goes away does not hear of a release
    onChange();
    show();
  });
  show();
  box.classList.add("thumbs");
  box.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false }); // an iPhone's magnifying glass
  box.replaceChildren(pad, zone, fire);
}

function arrow(direction) {
  const svg = icon("triangle");
  svg.dataset.action = direction;
  return svg;
}
