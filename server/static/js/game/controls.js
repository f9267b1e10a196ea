// All that a player may hold on the game page, wired to its one driver: keys, thumbs, gamepads; and what driving does to the page.

import { connectKeyboard, connectLetGo } from "../drive/controls.js";
import * as dialogs from "../common/dialogs.js";
import { Gamepads } from "../drive/gamepad.js";
import { Awake } from "../common/screen.js";
import { connectStillness } from "../drive/touch.js";
import { connectThumbs } from "./thumbs.js";
import { t } from "../common/words.js";

/**
 * @param {object} page
 * @param {import("../drive/driver.js").Driver} page.driver
 * @param {import("../common/preferences_store.js").Preferences} page.preferences
 * @param {import("../common/speaker.js").Speaker} page.speaker
 * @param {HTMLElement} page.thumbs an empty element for the controls on a touch screen
 * @param {HTMLElement} page.padHint tells a gamepad's buttons while there is a gamepad and hints are wanted
 * @param {() => void} page.onChange is called after each change of what is held
 * @param {() => void} page.onReady Start has been pressed on a gamepad
 * @param {(count: number) => void} page.onPads so many gamepads are there now
 */
export function connectGame({ driver, preferences, speaker, thumbs, padHint, onChange, onReady, onPads }) {
  connectKeyboard(window, driver, onChange);
  connectLetGo(driver, onChange);
  connectThumbs(thumbs, driver, preferences, onChange);
  connectStillness(document, () => driver.driving);
  speaker.listen(window);

  const awake = new Awake(navigator.wakeLock, document);
  driver.watch((driving) => {
    document.body.classList.toggle("is-driving", driving);
    awake.hold(driving);
  });

  padHint.textContent = t("controls.gamepad");
  let count = 0;
  const showHint = () => (padHint.hidden = count === 0 || !preferences.get("hints"));
  preferences.watch(showHint);
  const pads = new Gamepads({
    driver,
    getPads: () => navigator.getGamepads?.() ?? [], // some browsers have it by https only
    nextFrame: (look) => requestAnimationFrame(look),
    isOurs: () => document.hasFocus() && !dialogs.isOpen(),
    onChange,
    onPress: (action) => {
      speaker.wake();
      if (action === "ready") onReady();
      else preferences.toggle("sound");
    },
    onCount: (now) => {
      count = now;
      showHint();
      onPads(now);
    },
  });
  addEventListener("gamepadconnected", () => pads.update());
  addEventListener("gamepaddisconnected", () => pads.update());
  pads.update();
}
