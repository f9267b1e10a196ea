// The operator's desk: what is going on, and what an operator may do about it.

import * as api from "./api.js";
import * as dialogs from "../common/dialogs.js";
import { RulesForm, WordsForm } from "./forms.js";
import { Cameras } from "./cameras.js";
import { FloorEditor } from "./floor.js";
import { Journal } from "./journal.js";
import { LightCheck } from "./light_check.js";
import { Presets } from "./presets.js";
import { ruleName } from "./rule_words.js";
import { SoundCheck } from "./sound_check.js";
import { Tournament } from "./tournament.js";
import { TestDrive } from "./drive.js";
import { INTERVAL, Poll } from "./poll.js";
import * as view from "./view.js";
import { ADDED_TIME } from "./words.js";
import { AudienceVote } from "./vote.js";
import { connectPreferences } from "../common/preferences.js";
import { presetName } from "../common/preset_names.js";
import { list, t } from "../common/words.js";

const byId = (id) => document.getElementById(id);

const rules = new RulesForm((name) => act(() => api.setRules({ [name]: null }), () => rules.forget(name)));
const applyPreset = (preset) =>
  act(
    () => api.setRules(preset.rules),
    () => {
      rules.forget(...Object.keys(rules.changed).filter((name) => name in preset.rules));
      dialogs.toast(t("desk.preset_applied", { name: presetName(preset) }));
    },
  );
const presets = new Presets({
  apply: applyPreset,
  save: (name) => {
    const unsaved = Object.keys(rules.changed);
    if (unsaved.length) return view.showProblem(t("desk.preset_unsaved", { names: list(unsaved.map(ruleName)) }));
    return act(
      () => api.presets({ save: name }),
      () => {
        byId("preset-form").reset();
        dialogs.toast(t("desk.preset_saved", { name }));
      },
    );
  },
  remove: ({ name }) => act(() => api.presets({ remove: name })),
});
const vote = new AudienceVote({
  open: (choices, seconds) => act(() => api.openVote(choices, seconds), () => vote.ask()),
  apply: applyPreset,
});
const tournament = new Tournament((order, then) => act(() => api.tournament(order), then), view.showProblem);
const words = new WordsForm();
const drive = new TestDrive();
const cameras = new Cameras();
const journal = new Journal();
const lightCheck = new LightCheck(showFailure);
const floor = new FloorEditor(act, showFailure);
const soundCheck = new SoundCheck();

const poll = new Poll({
  ask: api.state,
  now: Date.now,
  onState: (state) => {
    view.showLost(null);
    view.showState(state, on);
    rules.show(state.rules);
    presets.show(state.presets, state.rules);
    vote.show(state.presets);
    words.show(state.names.words);
    tournament.show(state);
    journal.show(state.has_journal);
    floor.show(state.game);
    lightCheck.show(state.game, state.robots, state.rules.practice.value);
    const driven = state.robots.find(({ id }) => id === drive.robot);
    if (!driven || driven.in_service) drive.stop();
  },
  onLost: view.showLost,
  onSignedOut: () => location.reload(), // the server answers with its login
});

/** Do what somebody has asked for; say why when it cannot be done. Afterwards the desk shows what has become of it. */
async function act(order, then = () => {}) {
  try {
    await order();
    view.showProblem("");
    then();
  } catch (error) {
    showFailure(error);
  }
  await poll.refresh();
}

function showFailure(error) {
  if (error.status === 401) location.reload();
  if (error.status) view.showProblem(error.message, error.lang);
  else view.showProblem(t("desk.no_answer"));
}

/** Do it once somebody has said yes. */
async function confirm({ title, text, ok }, order, then) {
  if (await dialogs.show({ kind: "warning", title, text, ok, cancel: t("common.cancel"), calm: true })) await act(order, then);
}

const on = {
  service: (id, inService) => act(() => api.setService(id, inService)),
  bot: (id, level) => act(() => api.giveToBot(id, level)),
  identify: (id) => act(() => api.identify(id)),
  look: (id) => cameras.look(id),
  drive: (id) => act(() => drive.start(id)),
  signOut: (name) =>
    confirm({ title: t("desk.sign_out_sure", { name }), text: t("desk.sign_out_text"), ok: t("desk.sign_out_player") }, () =>
      api.signOut(name),
    ),
  ban: (name, then) =>
    confirm(
      { title: t("desk.ban_sure", { name }), text: t("desk.ban_text"), ok: t("desk.ban") },
      () => api.names({ ban: name }),
      then,
    ),
  unban: (name) => act(() => api.names({ unban: name })),
};

function order(action) {
  if (action === "add_time") return act(() => api.battle({ action, seconds: ADDED_TIME }));
  const send = () => api.battle({ action });
  if (action !== "abort") return act(send);
  return confirm({ title: t("desk.abort_sure"), text: t("desk.abort_text"), ok: t("desk.abort") }, send);
}

byId("battle-buttons").addEventListener("click", ({ target }) => {
  const button = target.closest("button");
  if (button?.getAttribute("aria-disabled") === "false") order(button.dataset.order);
});

/** A form's submit does `send`, then `then`. */
function onSubmit(id, send, then) {
  byId(id).addEventListener("submit", (event) => {
    event.preventDefault();
    act(send, then);
  });
}

onSubmit(
  "message-form",
  () => api.showMessage(byId("message-text").value.trim()),
  () => byId("message-form").reset(),
);
onSubmit("rules-form", () => api.setRules(rules.changed), () => dialogs.toast(t("desk.rules_saved")));
onSubmit("words-form", () => api.names({ words: words.words }), () => dialogs.toast(t("desk.words_saved")));
byId("ban-form").addEventListener("submit", (event) => {
  event.preventDefault();
  on.ban(byId("ban-name").value.trim().normalize("NFC"), () => byId("ban-form").reset());
});
byId("message-clear").addEventListener("click", () => {
  byId("message-text").focus(); // the button goes
  act(() => api.showMessage(""));
});
byId("check-sound").addEventListener("click", () => {
  soundCheck.play();
  dialogs.toast(t("desk.sound_hear"));
});
byId("problem-close").addEventListener("click", () => view.showProblem(""));
byId("sign-out").addEventListener("click", async () => {
  await api.leave().catch(() => null);
  location.replace("/operator");
});
addEventListener("pageshow", (event) => event.persisted && location.reload());

connectPreferences();
cameras.start();
journal.start();
floor.start();
vote.start();

const tick = () => poll.tick(document.hidden);
document.addEventListener("visibilitychange", tick);
setInterval(tick, INTERVAL / 4);
tick();
