// A page with nothing but the game's controls, for their tests: what would go to the robot stays in `game.sent`.

import "../../../server/static/css/common.css";
import "../../../server/static/css/touch.css";
import { Driver } from "../../../server/static/js/drive/driver.js";
import { Feedback } from "../../../server/static/js/battle/feedback.js";
import { connectGame } from "../../../server/static/js/game/controls.js";
import { connectSwitches, settingsForm } from "../../../server/static/js/game/settings.js";
import { makeJolt, vibrate } from "../../../server/static/js/common/jolt.js";
import { Preferences } from "../../../server/static/js/common/preferences_store.js";
import { SOUNDS, lengthOf } from "../../../server/static/js/common/sound.js";
import { Speaker, makeNoise, sound } from "../../../server/static/js/common/speaker.js";

const { document, navigator, OfflineAudioContext } = globalThis; // the linter takes this folder for node's

const byId = (id) => document.getElementById(id);
const preferences = new Preferences();
const speaker = new Speaker(preferences);
const feedback = new Feedback({ speaker, vibrate, jolt: makeJolt(byId("stage"), byId("flash")) });
const sent = [];
const readies = [];

const driver = new Driver({
  send: (command) => {
    sent.push(command);
    if (command.shoot) feedback.fire(performance.now());
  },
  every: (ms, act) => {
    const timer = setInterval(act, ms);
    return () => clearInterval(timer);
  },
});

function showHeld() {
  for (const node of document.querySelectorAll("[data-action]")) {
    node.classList.toggle("is-held", driver.actions.has(node.dataset.action));
  }
}

/** How loud each sound is at its loudest and on the average, by itself at full volume. */
async function loudness() {
  const found = {};
  for (const name of Object.keys(SOUNDS)) {
    const context = new OfflineAudioContext(1, Math.ceil(lengthOf(name) * 44100), 44100);
    sound(context, context.destination, makeNoise(context), name);
    const samples = (await context.startRendering()).getChannelData(0);
    const power = samples.reduce((sum, sample) => sum + sample * sample, 0) / samples.length;
    found[name] = { peak: samples.reduce((most, sample) => Math.max(most, Math.abs(sample)), 0), average: Math.sqrt(power) };
  }
  return found;
}

connectGame({
  driver, preferences, speaker, thumbs: byId("thumbs"), padHint: byId("pad-hint"), onChange: showHeld,
  onReady: () => readies.push(performance.now()),
  onPads: () => {},
});
connectSwitches({ sound: byId("sound"), fullscreen: byId("fullscreen") }, preferences);
byId("settings").append(settingsForm(preferences, speaker));
globalThis.game = { driver, feedback, preferences, speaker, sent, readies, loudness, pads: () => navigator.getGamepads().filter(Boolean).length };
